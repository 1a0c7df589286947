#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "report/hbExternalProgram.h"
#include "volume/hbError.h"
#include "volume/hbProgress.h"

/// zfp's best within a number of bytes.
struct hbZfpRun {
  std::string version;
  std::uint64_t bytes = 0; ///< Of its stream, header included.
  std::string mode;        ///< accuracy, precision, rate or reversible.
  double parameter = 0.0;  ///< The mode's own: tolerance in values, bit planes, bits a sample; 0.
  double rmse = 0.0;       ///< In values.
  int threads = 0;
  double secondsCompress = 0.0, secondsDecompress = 0.0; ///< Medians of three, of what was found best.
};

/// A scene drawn by VTK.
struct hbVtkRun {
  std::string version;
  std::string renderer;      ///< OpenGL's name for what drew; VTK's mapper on the CPU needs it to show pictures.
  int threads = 0;           ///< That VTK drew with at the most.
  double step = 0.0;         ///< World length between samples.
  double secondsFirst = 0.0; ///< The first picture, with all that VTK prepares for it.
  std::vector<double> secondsFrames; ///< Each of those after it.
};

/// What a peer cannot do, as opposed to what went wrong: its own line says so.
class hbPeerRefusal : public hbError {
public:
  using hbError::hbError;
};

/// Other programs to be put beside hbvol, where they are installed: hbvol_peer_zfp and hbvol_peer_vtk (bench/peers).
/// hbvol itself uses neither zfp nor VTK. Members may be called from any thread.
class hbPeers {
public:
  enum class VtkMapper : std::uint8_t { cpu, gpu };

  /// The folder of the running program, then $HBVOL_PEERS where it is set.
  static std::vector<std::filesystem::path> folders();

  /// Looks for the programs in these folders in their order, then along PATH. Runs nothing.
  explicit hbPeers(const std::vector<std::filesystem::path>& inFolders = folders());

  bool hasZfp() const { return zfp_.has_value(); }
  bool hasVtk() const { return vtk_.has_value(); }

  /// As in "1.0.0". These and the next two throw hbError with the program's name, and its last line where it has one,
  /// when it is missing, fails, or answers what is not expected; hbCancelled, the program being killed, where
  /// `progress` is.
  std::string zfpVersion(hbProgress& progress = hbProgress::none()) const;
  std::string vtkVersion(hbProgress& progress = hbProgress::none()) const;

  /// Compresses the volume file `in` (32-bit floats, one component) to at most `bytes` >= 1 bytes, and writes what is
  /// left of it to the volume file `out`, with the same geometry. Throws hbPeerRefusal where zfp has nothing so small,
  /// or values are not finite.
  hbZfpRun compress(const std::filesystem::path& in, std::uint64_t bytes, const std::filesystem::path& out,
                    hbProgress& progress = hbProgress::none()) const;

  /// Draws the volume file `in` (as above) and the complete scene in the file `scene` (camera, window, iso-value,
  /// transfer function, where its mode needs them) once and then `repeats` times, 1 to 10000, with at most `threads`
  /// threads (0: one a core), and writes the last picture to the PNG file `out`. Without a DISPLAY, xvfb-run gives it
  /// one, where that is installed. Throws hbPeerRefusal for what VTK does not draw as hbvol does (doc/peers.md).
  hbVtkRun render(const std::filesystem::path& in, const std::filesystem::path& scene, VtkMapper mapper, int repeats,
                  int threads, const std::filesystem::path& out, hbProgress& progress = hbProgress::none()) const;

private:
  std::optional<hbExternalProgram> zfp_, vtk_, display_;
};
