#include "report/hbPeers.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace {

constexpr std::string_view kZfp = "hbvol_peer_zfp", kVtk = "hbvol_peer_vtk";
constexpr int kRefused = 3;

const hbExternalProgram& existing(const std::optional<hbExternalProgram>& program, std::string_view name) {
  if (!program)
    throw hbError(
        fmt::format("{}: expected beside the running program, in $HBVOL_PEERS or on PATH, found in none", name));
  return *program;
}

/// What the peer `name` (zfp, vtk) writes to standard output.
std::string outputOf(const hbExternalProgram& program, std::string_view name, const std::vector<std::string>& arguments,
                     hbProgress& progress) {
  const hbExternalProgram::Result result = program.run(arguments, {}, progress);
  if (result.status == 0) return result.output;
  const std::string line = result.lastLine();
  // xvfb-run has the same status for a mistake of its own.
  if (result.status == kRefused && line.starts_with(fmt::format("{}: ", name))) throw hbPeerRefusal(line);
  throw hbError(fmt::format("{}: expected exit status 0, found {} and the message: {}", program.path().string(),
                            result.status, line));
}

/// The beginning of what was found, on one line.
std::string excerpt(std::string text) {
  constexpr std::size_t kMost = 80;
  if (text.size() > kMost) text = text.substr(0, kMost) + "...";
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 127; }, ' ');
  return text;
}

std::string versionOf(const hbExternalProgram& program, std::string_view name, hbProgress& progress) {
  const std::string text = outputOf(program, name, {"--version"}, progress);
  const std::string before = fmt::format("{} ", name);
  if (!text.starts_with(before) || text.find('\n') != text.size() - 1 || text.size() <= before.size() + 1)
    throw hbError(
        fmt::format("{}: expected {} and a version, found '{}'", program.path().string(), name, excerpt(text)));
  return text.substr(before.size(), text.size() - before.size() - 1);
}

/// `read` of the JSON object in `text`; throws hbError for what is none or what `read` does not find in it.
template <class Run, class Read>
Run runOf(const hbExternalProgram& program, const std::string& text, Read read) {
  try {
    return read(nlohmann::json::parse(text));
  } catch (const nlohmann::json::exception&) {
    throw hbError(
        fmt::format("{}: expected a JSON object of its run, found '{}'", program.path().string(), excerpt(text)));
  }
}

void expect(bool is, const hbExternalProgram& program, const char* what, const std::string& text) {
  if (!is) throw hbError(fmt::format("{}: expected {}, found '{}'", program.path().string(), what, excerpt(text)));
}

bool isTime(double seconds) { return std::isfinite(seconds) && seconds >= 0.0; }

} // namespace

std::vector<std::filesystem::path> hbPeers::folders() {
  std::vector<std::filesystem::path> found;
  std::error_code failed;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", failed);
  if (!failed) found.push_back(self.parent_path());
  const char* variable = std::getenv("HBVOL_PEERS");
  if (variable != nullptr && *variable != '\0') found.emplace_back(variable);
  return found;
}

hbPeers::hbPeers(const std::vector<std::filesystem::path>& inFolders)
    : zfp_(hbExternalProgram::find(kZfp, inFolders)), vtk_(hbExternalProgram::find(kVtk, inFolders)) {
  if (std::getenv("DISPLAY") == nullptr) display_ = hbExternalProgram::find("xvfb-run");
}

std::string hbPeers::zfpVersion(hbProgress& progress) const { return versionOf(existing(zfp_, kZfp), "zfp", progress); }

std::string hbPeers::vtkVersion(hbProgress& progress) const { return versionOf(existing(vtk_, kVtk), "vtk", progress); }

hbZfpRun hbPeers::compress(const std::filesystem::path& in, std::uint64_t bytes, const std::filesystem::path& out,
                           hbProgress& progress) const {
  const hbExternalProgram& program = existing(zfp_, kZfp);
  const std::string text = outputOf(program, "zfp", {in.string(), std::to_string(bytes), out.string()}, progress);
  const auto run = runOf<hbZfpRun>(program, text, [](const nlohmann::json& json) {
    return hbZfpRun{.version = json.at("version"),
                    .bytes = json.at("bytes"),
                    .mode = json.at("mode"),
                    .parameter = json.at("parameter"),
                    .rmse = json.at("rmse"),
                    .threads = json.at("threads"),
                    .secondsCompress = json.at("seconds_compress"),
                    .secondsDecompress = json.at("seconds_decompress")};
  });
  expect(run.bytes >= 1 && run.bytes <= bytes, program, fmt::format("1 to {} bytes", bytes).c_str(), text);
  expect(isTime(run.secondsCompress) && isTime(run.secondsDecompress), program, "times", text);
  return run;
}

hbVtkRun hbPeers::render(const std::filesystem::path& in, const std::filesystem::path& scene, VtkMapper mapper,
                         int repeats, int threads, const std::filesystem::path& out, hbProgress& progress) const {
  const hbExternalProgram& program = existing(vtk_, kVtk);
  std::vector<std::string> arguments{in.string(),
                                     scene.string(),
                                     mapper == VtkMapper::cpu ? "cpu" : "gpu",
                                     std::to_string(repeats),
                                     std::to_string(threads),
                                     out.string()};
  if (display_) {
    // A server that does not reset itself when the first window goes.
    const std::vector<std::string> before{"-a", "-s", "-noreset -screen 0 1024x1024x24", program.path().string()};
    arguments.insert(arguments.begin(), before.begin(), before.end());
  }
  const std::string text = outputOf(display_ ? *display_ : program, "vtk", arguments, progress);
  auto run = runOf<hbVtkRun>(program, text, [](const nlohmann::json& json) {
    return hbVtkRun{.version = json.at("version"),
                    .renderer = json.at("renderer"),
                    .threads = json.at("threads"),
                    .step = json.at("step"),
                    .secondsFirst = json.at("seconds_first"),
                    .secondsFrames = json.at("seconds_frames")};
  });
  expect(run.secondsFrames.size() == std::size_t(repeats), program, fmt::format("{} frames", repeats).c_str(), text);
  expect(run.threads >= 1 && (threads == 0 || run.threads <= threads), program,
         threads == 0 ? "a number of threads" : fmt::format("1 to {} threads", threads).c_str(), text);
  expect(isTime(run.secondsFirst) && std::all_of(run.secondsFrames.begin(), run.secondsFrames.end(), isTime), program,
         "times", text);
  return run;
}
