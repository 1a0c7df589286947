#include "bench/peers/vtkParts.h"

#include <string_view>

#include <vtkFloatArray.h>
#include <vtkPointData.h>

vtkNew<vtkImageData> peer::imageOf(const hbVolume& volume) {
  const hbGeometry& geometry = volume.geometry();
  const hbSize3 size = geometry.size;
  vtkNew<vtkFloatArray> samples;
  samples->SetArray(const_cast<float*>(reinterpret_cast<const float*>(volume.data())), geometry.samples(), 1);
  vtkNew<vtkImageData> image;
  image->SetDimensions(int(size.x), int(size.y), int(size.z));
  image->SetSpacing(geometry.spacing.x, geometry.spacing.y, geometry.spacing.z);
  image->GetPointData()->SetScalars(samples);
  return image;
}

vtkNew<vtkMatrix4x4> peer::placeOf(const hbGeometry& geometry) {
  vtkNew<vtkMatrix4x4> place;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) place->SetElement(row, column, geometry.direction[column][row]);
    place->SetElement(row, 3, geometry.origin[row]);
  }
  return place;
}

void peer::look(vtkCamera& camera, const hbCamera& from) {
  camera.SetPosition(from.position.x, from.position.y, from.position.z);
  camera.SetFocalPoint(from.target.x, from.target.y, from.target.z);
  camera.SetViewUp(from.up.x, from.up.y, from.up.z);
  camera.SetParallelProjection(from.projection == hbCamera::Projection::orthographic ? 1 : 0);
  camera.SetParallelScale(0.5 * from.height);
  camera.SetViewAngle(from.fieldOfView);
}

void peer::reflect(vtkVolumeProperty& property, const hbShading& shading) {
  property.ShadeOn();
  property.SetAmbient(shading.ambient);
  property.SetDiffuse(shading.diffuse);
  property.SetSpecular(shading.specular);
  property.SetSpecularPower(shading.shininess);
}

vtkNew<vtkFixedPointVolumeRayCastMapper> peer::onCpu(double step) {
  vtkNew<vtkFixedPointVolumeRayCastMapper> mapper;
  mapper->SetSampleDistance(float(step));
  mapper->SetInteractiveSampleDistance(float(step));
  mapper->AutoAdjustSampleDistancesOff();
  mapper->SetImageSampleDistance(1.0F);
  return mapper;
}

vtkNew<vtkGPUVolumeRayCastMapper> peer::onGpu(double step) {
  vtkNew<vtkGPUVolumeRayCastMapper> mapper;
  mapper->SetSampleDistance(float(step));
  mapper->AutoAdjustSampleDistancesOff();
  mapper->SetImageSampleDistance(1.0F);
  mapper->UseJitteringOff();
  return mapper;
}

std::string peer::rendererOf(vtkRenderWindow& window) {
  constexpr std::string_view kBefore = "OpenGL renderer string:";
  const std::string text = window.ReportCapabilities();
  std::size_t begin = text.find(kBefore);
  if (begin == std::string::npos) return "";
  begin = text.find_first_not_of(' ', begin + kBefore.size());
  return text.substr(begin, text.find('\n', begin) - begin);
}
