// VTK's volume mappers on the pictures of bench/dvr.cpp: the same samples, views, step and transfer functions. Items
// are nominal samples a second of process CPU time. Debian's VTK needs an X server even off screen, one that does not
// reset itself when a window goes: xvfb-run -s "-noreset -screen 0 1024x1024x24" hbvol_bench_vtk.
//
// The first frame, in which VTK prepares its tables, gradients and textures, is not counted. The mapper on the CPU has
// no X-ray: its additive mode composites.

#include <benchmark/benchmark.h>
#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkFixedPointVolumeRayCastMapper.h>
#include <vtkFloatArray.h>
#include <vtkGPUVolumeRayCastMapper.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPointData.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkVolume.h>
#include <vtkVolumeMapper.h>
#include <vtkVolumeProperty.h>

#include "bench/fields.h"
#include "bench/views.h"

namespace {

vtkNew<vtkImageData> imageOf(const hbVolume& volume) {
  const hbGeometry& geometry = volume.geometry();
  const hbSize3 size = geometry.size;
  vtkNew<vtkFloatArray> samples;
  samples->SetArray(const_cast<float*>(reinterpret_cast<const float*>(volume.data())), size.x * size.y * size.z, 1);
  vtkNew<vtkImageData> image;
  image->SetDimensions(int(size.x), int(size.y), int(size.z));
  image->SetSpacing(geometry.spacing.x, geometry.spacing.y, geometry.spacing.z);
  image->SetOrigin(geometry.origin.x, geometry.origin.y, geometry.origin.z);
  image->GetPointData()->SetScalars(samples);
  return image;
}

/// As hbvol lights: a white light where the viewer is.
void light(vtkVolumeProperty& property) {
  const hbShading shading;
  property.ShadeOn();
  property.SetAmbient(shading.ambient);
  property.SetDiffuse(shading.diffuse);
  property.SetSpecular(shading.specular);
  property.SetSpecularPower(shading.shininess);
}

void set(vtkVolumeProperty& property, const hbTransferFunction& function) {
  vtkNew<vtkColorTransferFunction> colours;
  for (const auto& point : function.definition().colors)
    colours->AddRGBPoint(point.value, point.rgb.r, point.rgb.g, point.rgb.b);
  vtkNew<vtkPiecewiseFunction> opacities;
  for (const auto& point : function.definition().opacities) opacities->AddPoint(point.value, point.opacity);
  property.SetColor(colours);
  property.SetScalarOpacity(opacities);
  property.SetScalarOpacityUnitDistance(*function.definition().unitLength);
  property.SetInterpolationTypeToLinear();
}

void look(vtkCamera& camera, const hbCamera& from) {
  camera.SetPosition(from.position.x, from.position.y, from.position.z);
  camera.SetFocalPoint(from.target.x, from.target.y, from.target.z);
  camera.SetViewUp(from.up.x, from.up.y, from.up.z);
  camera.SetParallelProjection(from.projection == hbCamera::Projection::orthographic ? 1 : 0);
  camera.SetParallelScale(0.5 * from.height);
  camera.SetViewAngle(from.fieldOfView);
}

vtkNew<vtkFixedPointVolumeRayCastMapper> onCpu(double step) {
  vtkNew<vtkFixedPointVolumeRayCastMapper> mapper;
  mapper->SetSampleDistance(float(step));
  mapper->SetInteractiveSampleDistance(float(step));
  mapper->AutoAdjustSampleDistancesOff();
  mapper->SetImageSampleDistance(1.0F);
  return mapper;
}
vtkNew<vtkGPUVolumeRayCastMapper> onGpu(double step) {
  vtkNew<vtkGPUVolumeRayCastMapper> mapper;
  mapper->SetSampleDistance(float(step));
  mapper->AutoAdjustSampleDistancesOff();
  mapper->SetImageSampleDistance(1.0F);
  mapper->UseJitteringOff();
  return mapper;
}

/// Arguments: samples an axis, whether oblique.
template <class MakeMapper>
void picture(benchmark::State& state, MakeMapper makeMapper, vtkVolumeMapper::BlendModes mode, bool everywhere = false,
             bool isLit = false) {
  const hbVolume& samples = bench::volume(int(state.range(0))).volume();
  const hbScene scene = bench::view(samples.geometry(), state.range(1) != 0);
  const vtkNew<vtkImageData> image = imageOf(samples);
  const auto mapper = makeMapper(scene.sampling.stepLength(samples.geometry(), *scene.camera));
  mapper->SetInputData(image);
  mapper->SetBlendMode(mode);

  vtkNew<vtkVolume> volume;
  volume->SetMapper(mapper);
  set(*volume->GetProperty(), bench::transfer(samples.geometry(), everywhere));
  if (isLit) light(*volume->GetProperty());
  vtkNew<vtkRenderer> renderer;
  renderer->AddVolume(volume);
  look(*renderer->GetActiveCamera(), *scene.camera);
  renderer->ResetCameraClippingRange();
  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(0);
  window->SetSize(scene.width, scene.height);
  window->AddRenderer(renderer);
  window->Render();
  for (auto _ : state) window->Render();
  state.SetItemsProcessed(std::int64_t(double(state.iterations()) * bench::nominalSamples(samples.geometry(), scene)));
}

constexpr auto kComposite = vtkVolumeMapper::COMPOSITE_BLEND;
void cpuMip(benchmark::State& state) { picture(state, onCpu, vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND); }
void cpuComposite(benchmark::State& state) { picture(state, onCpu, kComposite); }
void cpuEverywhere(benchmark::State& state) { picture(state, onCpu, kComposite, true); }
void cpuLit(benchmark::State& state) { picture(state, onCpu, kComposite, false, true); }
void gpuXray(benchmark::State& state) { picture(state, onGpu, vtkVolumeMapper::ADDITIVE_BLEND); }
void gpuMip(benchmark::State& state) { picture(state, onGpu, vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND); }
void gpuComposite(benchmark::State& state) { picture(state, onGpu, kComposite); }
void gpuLit(benchmark::State& state) { picture(state, onGpu, kComposite, false, true); }

} // namespace

BENCHMARK(cpuMip)->Name("vtk-cpu/mip")->Apply(bench::views);
BENCHMARK(cpuComposite)->Name("vtk-cpu/composite")->Apply(bench::views);
BENCHMARK(cpuEverywhere)->Name("vtk-cpu/composite-everywhere")->Apply(bench::views);
BENCHMARK(cpuLit)->Name("vtk-cpu/composite-shaded")->Apply(bench::views);
BENCHMARK(gpuXray)->Name("vtk-gpu/xray")->Apply(bench::views);
BENCHMARK(gpuMip)->Name("vtk-gpu/mip")->Apply(bench::views);
BENCHMARK(gpuComposite)->Name("vtk-gpu/composite")->Apply(bench::views);
BENCHMARK(gpuLit)->Name("vtk-gpu/composite-shaded")->Apply(bench::views);

BENCHMARK_MAIN();
