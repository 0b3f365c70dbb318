#pragma once
// The command line as declared: every command, option and example once. Parsing, --help,
// the man page and the completion all read the same declaration.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "terminal.h"

namespace brume::cli {

/// An option or argument as a person reads about it.
struct OptionDoc {
  std::string names;               ///< "-o,--output", or "SCENE" of an argument
  std::string value;               ///< "OUT"; empty: a flag
  std::string text;                ///< what it does
  std::vector<std::string> words;  ///< what the value may be, where that is a list
  bool argument = false, needed = false, repeats = false;
};

struct CommandDoc {
  std::string name, summary;  ///< "apply", one line
  std::string text;           ///< paragraphs
  std::vector<OptionDoc> options;
  std::vector<std::pair<std::string, std::string>> examples;  ///< command, what it does
};

/// What to do, ready to be done.
struct Invocation {
  std::function<int(const Terminal&)> run;
  Loudness loudness = Loudness::normal;
};

/// Reads the command line. Throws UsageError (commands.h).
Invocation parse(int argc, char** argv);

// ---- readers of the declaration (help.cpp)
std::string help_text(std::span<const CommandDoc>, int columns);  ///< of all commands
std::string help_text(const CommandDoc&, int columns);
std::string man_page(std::span<const CommandDoc>);
std::string bash_completion(std::span<const CommandDoc>);

}  // namespace brume::cli
