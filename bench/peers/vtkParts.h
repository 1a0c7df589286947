#pragma once

#include <string>

#include <vtkCamera.h>
#include <vtkFixedPointVolumeRayCastMapper.h>
#include <vtkGPUVolumeRayCastMapper.h>
#include <vtkImageData.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkVolumeProperty.h>

#include "scene/hbCamera.h"
#include "scene/hbShading.h"
#include "volume/hbVolume.h"

/// hbvol's terms in VTK's, for the benchmark and for the program that `hbvol compare` runs.
namespace peer {

/// Shares the samples, which must be packed 32-bit floats of one component in the machine's byte order. It lies at the
/// origin along the world's axes; placeOf() puts it where it belongs, as VTK's mappers know no directions of images.
vtkNew<vtkImageData> imageOf(const hbVolume& volume);
vtkNew<vtkMatrix4x4> placeOf(const hbGeometry& geometry);

void look(vtkCamera& camera, const hbCamera& from);

/// How matter reflects the white light where the viewer is; the shading's own lights are left out.
void reflect(vtkVolumeProperty& property, const hbShading& shading);

/// Samples every `step` of world length, one ray a pixel, and always so.
vtkNew<vtkFixedPointVolumeRayCastMapper> onCpu(double step);
vtkNew<vtkGPUVolumeRayCastMapper> onGpu(double step);

/// The name that OpenGL has for what draws in this window, once it has drawn.
std::string rendererOf(vtkRenderWindow& window);

} // namespace peer
