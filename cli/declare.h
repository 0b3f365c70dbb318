#pragma once
// What each command takes: options, arguments, examples.

#include <CLI/App.hpp>
#include <functional>
#include <string>
#include <vector>

#include "arguments.h"
#include "commands.h"

namespace brume::cli {

/// A command under declaration: CLI11 parses it, the doc is kept for those who read.
class Command {
 public:
  Command(CLI::App& main, CommandDoc& doc)
      : doc_(doc), app_(main.add_subcommand(doc.name, doc.summary)) {
    app_->set_help_flag();  // help is ours
  }

  // After all others: what every command takes.
  void finish() {
    flag("-v,--verbose", verbose, "Say more about what happens");
    flag("-q,--quiet", quiet, "Errors only");
    flag("-h,--help", help, "Show this help");
    for (std::size_t i = 0; i < options_.size(); ++i)
      doc_.options[i].needed = doc_.options[i].needed || options_[i]->get_required();
  }

  // The option declared last stands in the usage line, though --check goes without it.
  void usually_needed() { doc_.options.back().needed = true; }

  template <class T>
  CLI::Option* argument(const char* name, T& target, const char* text) {
    constexpr bool many = !std::is_same_v<T, std::string>;
    doc_.options.push_back({name, name, text, {}, true, false, many});
    options_.push_back(app_->add_option(name, target)->type_name(name));
    return options_.back();
  }

  void flag(const char* names, bool& target, const char* text) {
    doc_.options.push_back({names, "", text, {}, false, false, false});
    options_.push_back(app_->add_flag(names, target));
  }

  template <class T>
  CLI::Option* option(const char* names, const char* value, T& target, const char* text,
                      std::vector<std::string> words = {}) {
    constexpr bool many = std::is_same_v<T, std::vector<std::string>>;
    doc_.options.push_back({names, value, text, words, false, false, many});
    CLI::Option* o = app_->add_option(names, target)->type_name(value);
    options_.push_back(o);
    if constexpr (many) {
      o->allow_extra_args(false);  // each takes one, and may stand anywhere
    } else {
      o->take_last();
    }
    if (!words.empty()) o->check(CLI::IsMember(words));
    return o;
  }

  void example(const char* command, const char* text) {
    doc_.examples.emplace_back(command, text);
  }

  CLI::App& app() { return *app_; }
  bool help = false, verbose = false, quiet = false;
  std::function<int(const Terminal&)> run;

 private:
  CommandDoc& doc_;
  CLI::App* app_;
  std::vector<CLI::Option*> options_;  ///< as doc_.options
};

/// All commands, without their options.
std::vector<CommandDoc> commands();

void declare_apply(Command& c, ApplyArguments& a, std::string& region,
                   std::string& on_missing);
void declare_plan(Command& c, PlanArguments& a);
void declare_info(Command& c, InfoArguments& a);
void declare_stages(Command& c, StagesArguments& a);
void declare_probe(Command& c, ProbeArguments& a);
void declare_view(Command& c, ViewArguments& a);
void declare_diff(Command& c, DiffArguments& a);
void declare_stress(Command& c, StressArguments& a);
void declare_study(Command& c, StudyArguments& a);

}  // namespace brume::cli
