#include "arguments.h"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cstdio>
#include <deque>
#include <memory>

#include "declare.h"
#include "params/params.h"

namespace brume::cli {

namespace {

// "x,y,width,height" in pixels.
Window window_from(const std::string& text) {
  Window w;
  int end = 0;
  if (std::sscanf(text.c_str(), "%d,%d,%d,%d%n", &w.x, &w.y, &w.width, &w.height, &end) !=
          4 ||
      text[std::size_t(end)] != 0 || w.empty())
    throw CLI::ValidationError("--region",
                               fmt::format("\"{}\" is no region; write x,y,width,height "
                                           "in pixels, e.g. 960,540,512,512",
                                           text));
  return w;
}

std::vector<std::string> option_names(const CommandDoc& doc) {
  std::vector<std::string> names;
  for (const OptionDoc& o : doc.options)
    if (!o.argument) names.push_back(o.names.substr(o.names.find("--")));
  return names;
}

// What the parser found wrong, in our words.
std::string in_words(const CLI::ParseError& e, std::span<const CommandDoc> docs,
                     const CommandDoc* doc, const CLI::App* app) {
  const std::string help =
      doc ? fmt::format("see brume {} --help", doc->name) : "see brume --help";
  if (dynamic_cast<const CLI::ExtrasError*>(&e)) {
    std::vector<std::string> left = app ? app->remaining() : std::vector<std::string>{};
    if (left.empty()) return std::string(e.what()) + "; " + help;
    const std::string wrong = left.front().substr(0, left.front().find('='));
    if (wrong.starts_with('-') && doc) {
      const std::string near = nearest_name(wrong, option_names(*doc));
      return fmt::format("{}: no such option; {}", wrong,
                         near.empty() ? help : "did you mean " + near + "?");
    }
    if (!doc) {
      std::vector<std::string> names;
      for (const CommandDoc& d : docs) names.push_back(d.name);
      const std::string near = nearest_name(wrong, names);
      return fmt::format("{}: no such {}; {}", wrong,
                         wrong.starts_with('-') ? "option" : "command",
                         near.empty() ? help : "did you mean " + near + "?");
    }
    return fmt::format("{}: one argument too many; {}", wrong, help);
  }
  std::string what = e.what();
  for (char& c : what)
    if (c == '\n') c = ' ';
  return fmt::format("{}; {}", what, help);
}

}  // namespace

Invocation parse(int argc, char** argv) {
  CLI::App main("brume");
  main.set_help_flag();
  main.allow_extras();
  bool help = false, version = false, man = false, completion = false;
  main.add_flag("-h,--help", help);
  main.add_flag("--version", version);
  main.add_flag("--man", man);                // brume.1, made when brume is built
  main.add_flag("--completion", completion);  // bash, likewise

  std::vector<CommandDoc> docs = commands();
  auto apply_arguments = std::make_shared<ApplyArguments>();
  auto plan_arguments = std::make_shared<PlanArguments>();
  auto info_arguments = std::make_shared<InfoArguments>();
  auto stages_arguments = std::make_shared<StagesArguments>();
  auto probe_arguments = std::make_shared<ProbeArguments>();
  auto view_arguments = std::make_shared<ViewArguments>();
  auto diff_arguments = std::make_shared<DiffArguments>();
  auto stress_arguments = std::make_shared<StressArguments>();
  auto study_arguments = std::make_shared<StudyArguments>();
  std::string region, on_missing;

  std::deque<Command> declared;
  for (CommandDoc& doc : docs) declared.emplace_back(main, doc);
  // Options of the commands that are named, and of all where pages are made of them:
  // declaring the others would be a tenth of a start.
  const auto named = [&](std::string_view word) {
    return std::find(argv, argv + argc, word) != argv + argc;
  };
  const auto command = [&](std::size_t i, auto function, auto arguments, auto declare) {
    if (!named(docs[i].name) && !named("--man") && !named("--completion")) return;
    declare(declared[i], *arguments);
    declared[i].run = [=](const Terminal& t) { return function(*arguments, t); };
    declared[i].finish();
  };
  command(0, apply, apply_arguments, [&](Command& c, ApplyArguments& a) {
    declare_apply(c, a, region, on_missing);
  });
  command(1, plan, plan_arguments, declare_plan);
  command(2, info, info_arguments, declare_info);
  command(3, stages, stages_arguments, declare_stages);
  command(4, probe, probe_arguments, declare_probe);
  command(5, view, view_arguments, declare_view);
  command(6, diff, diff_arguments, declare_diff);
  command(7, stress, stress_arguments, declare_stress);
  command(8, study, study_arguments, declare_study);
  study_arguments->command = "brume";
  for (int i = 1; i < argc; ++i) study_arguments->command += std::string(" ") + argv[i];

  const auto print = [](std::string text) {
    return Invocation{[text = std::move(text)](const Terminal&) {
      std::fputs(text.c_str(), stdout);
      return int(kOk);
    }};
  };

  // Help asked for anywhere wins over what else may be wrong.
  const auto help_of = [&](std::size_t i, const Terminal& t) {
    return help_text(docs[i], t.columns());
  };
  for (std::size_t i = 0; argc > 1 && i < docs.size(); ++i)
    if (docs[i].name == argv[1])
      for (int k = 2; k < argc; ++k)
        if (std::string_view(argv[k]) == "--help" || std::string_view(argv[k]) == "-h")
          return print(help_of(i, Terminal()));
  if (argc > 1 && std::string_view(argv[1]) == "help") {
    if (argc == 2) return print(help_text(docs, Terminal().columns()));
    for (std::size_t i = 0; argc == 3 && i < docs.size(); ++i)
      if (docs[i].name == argv[2]) return print(help_of(i, Terminal()));
  }

  try {
    main.parse(argc, argv);
    for (std::size_t i = 0; i < docs.size(); ++i)
      if (declared[i].app().parsed() && !declared[i].app().remaining().empty())
        throw CLI::ExtrasError(docs[i].name, declared[i].app().remaining());
    if (!main.remaining().empty()) throw CLI::ExtrasError("brume", main.remaining());
    if (!region.empty()) apply_arguments->region = window_from(region);
  } catch (const CLI::ParseError& e) {
    for (std::size_t i = 0; i < docs.size(); ++i)
      if (declared[i].app().parsed() || (argc > 1 && docs[i].name == argv[1]))
        throw UsageError(docs[i].name + ": " +
                         in_words(e, docs, &docs[i], &declared[i].app()));
    throw UsageError(in_words(e, docs, nullptr, &main));
  }

  if (help) return print(help_text(docs, Terminal().columns()));
  if (version) return print("brume " BRUME_VERSION "\n");
  if (man) return print(man_page(docs));
  if (completion) return print(bash_completion(docs));
  apply_arguments->skip_missing = on_missing == "skip";
  for (Command& c : declared)
    if (c.app().parsed())
      return {c.run, c.quiet     ? Loudness::quiet
                     : c.verbose ? Loudness::verbose
                                 : Loudness::normal};
  throw UsageError("what shall it do? " + std::string("see brume --help"));
}

}  // namespace brume::cli
