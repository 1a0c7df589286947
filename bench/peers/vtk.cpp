// VTK's volume mappers on the pictures of bench/dvr.cpp: the same samples, views, step and transfer functions. Items
// are nominal samples a second of process CPU time. Debian's VTK needs an X server even off screen, one that does not
// reset itself when a window goes: xvfb-run -s "-noreset -screen 0 1024x1024x24" hbvol_bench_vtk.
//
// The first frame, in which VTK prepares its tables, gradients and textures, is not counted. The mapper on the CPU has
// no X-ray: its additive mode composites.

#include <benchmark/benchmark.h>
#include <vtkColorTransferFunction.h>
#include <vtkNew.h>
#include <vtkPiecewiseFunction.h>
#include <vtkRenderer.h>
#include <vtkVolume.h>
#include <vtkVolumeMapper.h>

#include "bench/fields.h"
#include "bench/peers/vtkParts.h"
#include "bench/views.h"
#include "raycast/hbNominalSamples.h"

namespace {

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

/// Arguments: samples an axis, whether oblique.
template <class MakeMapper>
void picture(benchmark::State& state, MakeMapper makeMapper, vtkVolumeMapper::BlendModes mode, bool everywhere = false,
             bool isLit = false) {
  const hbVolume& samples = bench::volume(int(state.range(0))).volume();
  const hbScene scene = bench::view(samples.geometry(), state.range(1) != 0);
  const vtkNew<vtkImageData> image = peer::imageOf(samples);
  const auto mapper = makeMapper(scene.sampling.stepLength(samples.geometry(), *scene.camera));
  mapper->SetInputData(image);
  mapper->SetBlendMode(mode);

  vtkNew<vtkVolume> volume;
  volume->SetMapper(mapper);
  volume->SetUserMatrix(peer::placeOf(samples.geometry()));
  set(*volume->GetProperty(), bench::transfer(samples.geometry(), everywhere));
  if (isLit) peer::reflect(*volume->GetProperty(), hbShading());
  vtkNew<vtkRenderer> renderer;
  renderer->AddVolume(volume);
  peer::look(*renderer->GetActiveCamera(), *scene.camera);
  renderer->ResetCameraClippingRange();
  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(0);
  window->SetSize(scene.width, scene.height);
  window->AddRenderer(renderer);
  window->Render();
  for (auto _ : state) window->Render();
  state.SetItemsProcessed(std::int64_t(double(state.iterations()) * hb::nominalSamples(samples.geometry(), scene)));
}

constexpr auto kComposite = vtkVolumeMapper::COMPOSITE_BLEND;
void cpuMip(benchmark::State& state) { picture(state, peer::onCpu, vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND); }
void cpuComposite(benchmark::State& state) { picture(state, peer::onCpu, kComposite); }
void cpuEverywhere(benchmark::State& state) { picture(state, peer::onCpu, kComposite, true); }
void cpuLit(benchmark::State& state) { picture(state, peer::onCpu, kComposite, false, true); }
void gpuXray(benchmark::State& state) { picture(state, peer::onGpu, vtkVolumeMapper::ADDITIVE_BLEND); }
void gpuMip(benchmark::State& state) { picture(state, peer::onGpu, vtkVolumeMapper::MAXIMUM_INTENSITY_BLEND); }
void gpuComposite(benchmark::State& state) { picture(state, peer::onGpu, kComposite); }
void gpuLit(benchmark::State& state) { picture(state, peer::onGpu, kComposite, false, true); }

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
