#include "tests/report/hbTestReport.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/hbPictureFile.h"

namespace {

using Json = nlohmann::ordered_json;

Json errors(double rmse) {
  const Json psnr = rmse > 0 ? Json(20 * std::log10(254 / rmse)) : Json();
  return {{"max", 8 * rmse}, {"rmse", rmse}, {"psnr", psnr}};
}

Json pictureErrors(double rmse) {
  Json result = errors(rmse);
  result["ssim"] = 1 - rmse / 1000;
  result["luv_mean"] = rmse / 7;
  result["luv_max"] = rmse / 2;
  return result;
}

Json choice(const std::string& kind, const Json& level, const std::string& label, std::int64_t bytes, double rmse) {
  const bool original = kind == "original";
  return {{"key", original ? kind : kind + "-" + level.dump()},
          {"kind", kind},
          {"label", label},
          {"level", level},
          {"status", "done"},
          {"error", nullptr},
          {"bytes", bytes},
          {"bits_per_sample", double(bytes) * 8 / 7109137},
          {"seconds_build", original ? 0.0 : 0.0123456789},
          {"stored_values", original ? Json() : Json(bytes / 4)},
          {"size", original ? Json({181, 217, 181}) : Json()},
          {"values", errors(rmse)},
          {"true_values", nullptr},
          {"order", original || level == 5 ? Json() : Json(0.98765)},
          {"true_order", nullptr}};
}

void fail(Json& thing, const std::string& error) {
  for (auto& [key, value] : thing.items())
    if (value.is_number() && key != "level" && key != "run") value = nullptr;
  for (const char* key : {"values", "seconds_frame", "picture", "image", "difference", "size"})
    if (thing.contains(key)) thing[key] = nullptr;
  thing["status"] = "failed";
  thing["error"] = error;
}

/// A case whose figures follow from its place among the others.
Json makeCase(const Json& of, const std::string& engine, const std::string& mode, int place) {
  const std::string key = of["key"].get<std::string>() + "-" + engine + "-" + mode, image = "pictures/" + key;
  const double seconds = 0.0123456 * (1 + place), samples = 4194304;
  const bool exact = of["kind"] == "original" || (mode == "mip" && of["key"] == "sparse-6");
  Json result{{"key", key},
              {"choice", of["key"]},
              {"engine", engine},
              {"mode", mode},
              {"status", "done"},
              {"error", nullptr},
              {"run", 1},
              {"seconds_build", 0.001},
              {"seconds_first_picture", 3 * seconds},
              {"seconds_warmup", 2 * seconds},
              {"seconds_frame", {{"median", seconds}, {"min", 0.9 * seconds}, {"max", 1.1 * seconds}, {"repeats", 5}}},
              {"samples", samples},
              {"samples_per_second", samples / seconds},
              {"compressed_bytes", of["bytes"]},
              {"resident_bytes", 84996 + place},
              {"memory_growth_bytes", 100000},
              {"texture_bytes", engine == "opengl" ? 1 << 20 : 0},
              {"picture", pictureErrors(exact ? 0.0 : 100.0 / (3 + place))},
              {"true_picture", nullptr},
              {"image", image + ".png"},
              {"difference", of["kind"] == "original" ? Json() : Json(image + "-difference.png")},
              {"pareto_time", place % 3 == 0},
              {"pareto_bytes", place % 4 == 0}};
  if (of["status"] == "failed") fail(result, of["error"]);
  return result;
}

Json hardCases() {
  return {{"cases",
           {{{"name", "checkerboard"},
             {"why", "alternating signs on the finest nodes"},
             {"amplification", 221},
             {"results",
              {{{"engine", "direct"},
                {"format", ""},
                {"error", 1.1e-7},
                {"error_of_range", 5.5e-8},
                {"bound", 3.2e-7},
                {"share", 0.75},
                {"within_bound", true},
                {"exceeds_bound", false},
                {"says_nothing", false},
                {"stable", true},
                {"status", "done"},
                {"note", ""}},
               {{"engine", "opengl-blend"},
                {"format", "r8"},
                {"error", nullptr},
                {"error_of_range", nullptr},
                {"bound", nullptr},
                {"share", nullptr},
                {"within_bound", false},
                {"exceeds_bound", false},
                {"says_nothing", false},
                {"stable", false},
                {"status", "refused"},
                {"note", "beyond <the> format"}},
               {{"engine", "opengl-blend"},
                {"format", "r16"},
                {"error", 6.0},
                {"error_of_range", 3.0},
                {"bound", 2.5},
                {"share", 2.4},
                {"within_bound", false},
                {"exceeds_bound", true},
                {"says_nothing", true},
                {"stable", false},
                {"status", "done"},
                {"note", ""}},
               {{"engine", "opengl-blend"},
                {"format", "r16f"},
                {"error", 0.5},
                {"error_of_range", 0.25},
                {"bound", 2.5},
                {"share", 0.2},
                {"within_bound", false},
                {"exceeds_bound", false},
                {"says_nothing", true},
                {"stable", false},
                {"status", "done"},
                {"note", ""}}}},
             {"most_stable", "direct"},
             {"reason", "no term is larger than the value"}}}}};
}

Json frame(Json choices, Json modes) {
  return {{"version", "0.1.0"},
          {"command", "hbvol compare 'a <b> & \"c\".nrrd' --out Gr\xc3\xb6\xc3\x9f"
                      "e --levels 5..6"},
          {"machine",
           {{"processor", "AMD <EPYC> & \"co\""},
            {"cores", 2},
            {"memory_bytes", 8589934592},
            {"system", "Linux 6.1"},
            {"compiler", "GNU 12.2.0"},
            {"instruction_set", "AVX3"},
            {"threads", 2},
            {"gl_renderer", nullptr}}},
          {"input",
           {{"name", "a <b> & \"c\" 'd' \xc3\x84.nrrd"},
            {"representation", "volume"},
            {"size", {181, 217, 181}},
            {"samples", 7109137},
            {"component", 0},
            {"bytes_uncompressed", 7109137},
            {"range", {0, 254.5}}}},
          {"settings",
           {{"levels", {5, 6}},
            {"engines", {"seminodal", "opengl"}},
            {"modes", std::move(modes)},
            {"width", 24},
            {"height", 16},
            {"samples", 128},
            {"sampling", "planewise"},
            {"repeats", 5}}},
          {"runs", 1},
          {"choices", std::move(choices)},
          {"cases", Json::array()},
          {"recommendations",
           {{{"question", "max error <= 2.55"},
             {"mode", nullptr},
             {"limit", 2.55},
             {"case", nullptr},
             {"choice", nullptr},
             {"answer", "nothing measured keeps it"}},
            {{"question", "<= 1 MB"},
             {"mode", "mip"},
             {"limit", 1048576},
             {"case", nullptr},
             {"choice", "sparse-6"},
             {"answer", "sparse grid, level 6: 14.5 kB"}}}},
          {"peers", {{"zfp", "1.0.0"}, {"vtk", nullptr}}},
          {"plots", nullptr},
          {"hard_cases", nullptr}};
}

void addCases(Json& report) {
  for (const Json& mode : report["settings"]["modes"]) {
    int place = 0;
    for (const Json& of : report["choices"]) {
      const std::vector<std::string> engines =
          of["kind"] == "sparse" ? std::vector<std::string>{"seminodal", "opengl"} : std::vector<std::string>{"full"};
      for (const std::string& engine : engines) report["cases"].push_back(makeCase(of, engine, mode, place++));
    }
  }
}

} // namespace

Json hb::test::report() {
  Json choices = {choice("original", nullptr, "the volume itself", 7109137, 0.0),
                  choice("sparse", 5, "sparse grid, level 5", 6144, 40.5),
                  choice("sparse", 6, "sparse grid, level 6", 14852, 20.41234567890123),
                  choice("coarse", 5, "full grid 12 x 12 x 12", 6912, 38.0),
                  choice("coarse", 6, "full grid 15 x 15 x 15", 13500, 30.0),
                  choice("zfp", 5, "zfp 1.0.0", 6000, 33.0),
                  choice("zfp", 6, "zfp 1.0.0", 14000, 21.0)};
  fail(choices[5], "zfp: expected a rate of at least 0.01, found 0.005 <\"&'> Gr\xc3\xb6\xc3\x9f"
                   "e");
  Json result = frame(std::move(choices), {"xray", "mip"});
  result["hard_cases"] = hardCases();
  addCases(result);
  return result;
}

Json hb::test::fittedReport() {
  Json result = report();
  result["settings"]["fits"] = {"least-squares"};
  result["settings"]["loss"] = "huber";
  for (const int level : {5, 6}) {
    const std::string label = "least squares, level " + std::to_string(level);
    Json fit = choice("least-squares", level, level == 5 ? label + " (interpolation kept)" : label,
                      level == 5 ? 6200 : 16123, level == 5 ? 40.5 : 10.123456);
    fit["fit"] = {{"method", "least-squares"}, {"loss", "huber"},
                  {"held_out_rmse", 11.23456}, {"interpolation_held_out_rmse", 22.3456},
                  {"improved", level == 6},    {"seconds", 1.23456}};
    for (const Json& mode : result["settings"]["modes"])
      result["cases"].push_back(makeCase(fit, "seminodal", mode, 7 + level));
    result["choices"].push_back(std::move(fit));
  }
  return result;
}

Json hb::test::vtkCase(const Json& report, const std::string& mode) {
  Json result = makeCase(report["choices"][0], "vtk-gpu", mode, 0);
  result["image_only"] = true;
  result["seconds_frame"]["median"] = 0.00123456;
  result["picture"] = pictureErrors(14.5);
  result["pareto_time"] = result["pareto_bytes"] = false;
  return result;
}

Json hb::test::smallReport() {
  Json result = frame({choice("original", nullptr, "the volume itself", 7109137, 0.0),
                       choice("sparse", 5, "sparse grid, level 5", 6144, 40.5)},
                      Json::array({"xray"}));
  result["settings"]["levels"] = {5};
  result["recommendations"] = Json::array();
  addCases(result);
  return result;
}

void hb::test::writePictures(const Json& report, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder / "pictures");
  std::uint8_t shade = 0;
  for (const Json& one : report.at("cases"))
    for (const char* key : {"image", "difference"}) {
      if (!one.at(key).is_string()) continue;
      hbImage8 image{24, 16, std::vector<std::uint8_t>(std::size_t(3 * 24 * 16), shade++)};
      writePng(image, folder / one.at(key).get<std::string>());
    }
}
