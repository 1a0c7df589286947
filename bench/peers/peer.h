#pragma once

#include <functional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "volume/hbError.h"

/// What the programs share that let `hbvol compare` put other programs beside hbvol. doc/peers.md describes how they
/// are called.
namespace peer {

/// What the other program cannot do, as opposed to what went wrong.
class Refused : public hbError {
public:
  using hbError::hbError;
};

/// A program's main(): given `--version` it prints `name version`. Otherwise it takes as many arguments as `usage` has
/// words, prints the object that `work` returns as one line of JSON, and returns 0; 1 where something went wrong, 2 for
/// wrong usage, and 3 where `work` refused. All but 0 come with one line on stderr that begins with `name`.
int run(int count, char** arguments, std::string_view name, std::string_view version, std::string_view usage,
        const std::function<nlohmann::ordered_json(char** arguments)>& work);

/// The text without line feeds, nor blanks at its end.
std::string oneLine(std::string text);

/// The whole number that `text` is, in [least, most]; throws hbError beginning with `what` for anything else.
std::uint64_t wholeNumber(std::string_view text, const std::string& what, std::uint64_t least, std::uint64_t most);

/// How long `work` takes, in seconds of wall time.
double seconds(const std::function<void()>& work);

} // namespace peer
