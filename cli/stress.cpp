// brume stress: every stage over stiff and extreme cases, held against laws and the
// truth.

#include "stress/stress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "commands.h"
#include "image/atomic_file.h"
#include "json.h"
#include "stage/registry.h"
#include "stress/isas.h"
#include "table.h"

namespace brume::cli {

namespace {

stress::Law law(std::size_t k) { return static_cast<stress::Law>(k); }

// What makes a case again.
std::string command(const StressArguments& a, const std::string& stage,
                    const stress::Report& r, const stress::Finding& f) {
  std::string text =
      fmt::format("brume stress {} --seed {} --case {}", stage, r.seed, f.worst_case);
  for (const std::string& file : a.plugins) text += " --plugin " + file;
  return text;
}

void print_table(const StressArguments& a, const stress::Report& r) {
  fmt::print(
      "{}: {} cases against laws, {} against the truth{}, {:.1f} s, seed {}{}{}{}\n",
      r.stage, r.cases, r.truths,
      r.undecided ? fmt::format(" ({} more undecided)", r.undecided) : "", r.seconds,
      r.seed, r.idle ? fmt::format("; {} worlds idle", r.idle) : "",
      r.refused ? fmt::format("; {} refused ({})", r.refused, r.refusal) : "",
      r.given_up ? fmt::format("; {} worlds given up as too dear (case {})", r.given_up,
                               r.first_given_up)
                 : "");
  std::vector<std::vector<std::string>> rows = {
      {"law", "", "checked", "undecided", "broken", "worst/allowed", "reproduce"}};
  for (std::size_t k = 0; k < r.findings.size(); ++k) {
    const stress::Finding& f = r.findings[k];
    if (f.checked + f.undecided == 0) continue;
    rows.push_back({name(law(k)), meaning(law(k)), fmt::format("{}", f.checked),
                    f.undecided ? fmt::format("{}", f.undecided) : "",
                    fmt::format("{}", f.broken), fmt::format("{:.2g}", f.worst),
                    f.worst > 0 ? command(a, r.stage, r, f) : ""});
  }
  std::fputs(table(rows).c_str(), stdout);
}

void print_broken(const stress::Report& r, const stress::Maker& maker,
                  const stress::Options& o) {
  for (std::size_t k = 0; k < r.findings.size(); ++k) {
    const stress::Finding& f = r.findings[k];
    if (f.broken == 0) continue;
    fmt::print("\n{} broken, case {}: {} ({}) is {:.9g}, not {:.9g}; allowed {:.2g}\n{}",
               name(law(k)), f.worst_case, meaning(law(k)),
               std::string("RGB")[std::size_t(f.channel)], f.got, f.wanted, f.allowed,
               describe(maker, o, f.worst_case));
  }
}

void write_json(Json& json, const StressArguments& a, const stress::Report& r) {
  json.object().key("stage").value(r.stage).key("seed").value(double(r.seed));
  json.key("cases").value(double(r.cases)).key("truths").value(double(r.truths));
  json.key("undecided").value(double(r.undecided));
  json.key("idle").value(double(r.idle)).key("refused").value(double(r.refused));
  json.key("given_up").value(double(r.given_up));
  json.key("seconds").value(r.seconds).key("ok").value(r.ok()).key("laws").array();
  for (std::size_t k = 0; k < r.findings.size(); ++k) {
    const stress::Finding& f = r.findings[k];
    json.object().key("name").value(name(law(k))).key("law").value(meaning(law(k)));
    json.key("checked").value(double(f.checked)).key("broken").value(double(f.broken));
    json.key("undecided").value(double(f.undecided));
    json.key("worst").value(f.worst).key("case").value(double(f.worst_case));
    json.key("got").value(f.got).key("wanted").value(f.wanted);
    json.key("allowed").value(f.allowed);
    json.key("reproduce").value(command(a, r.stage, r, f)).end();
  }
  json.end().end();
}

}  // namespace

int stress(const StressArguments& a, const Terminal& terminal) {
  Registry::Options options;
  for (const std::string& file : a.plugins) options.files.emplace_back(file);
  Registry registry(options);
  std::vector<const StageType*> types;
  for (const std::string& name : a.stages) types.push_back(&registry.find(name));
  std::vector<std::string> broken;
  if (a.stages.empty()) types = registry.all(&broken);
  for (const std::string& why : broken) terminal.warning(why);

  // Minutes before it is needed: can it be written?
  if (!a.json.empty()) AtomicFile{a.json};

  stress::Options o;
  o.cases = std::uint64_t(a.cases);
  o.seed = std::uint64_t(a.seed);
  o.seconds = a.seconds;
  if (a.only) o.only = std::uint64_t(*a.only);
  bool ok = true;
  Json json;
  json.array();
  StageCache cache;
  for (const StageType* type : types) {
    const stress::LowerIsas lower(*type);
    const stress::Maker maker = stress::maker_of(*type, cache, &lower);
    const stress::Report report = run(type->name, maker, o);
    if (a.only) fmt::print("{}", describe(maker, o, *o.only));
    if (terminal.loudness != Loudness::quiet) print_table(a, report);
    print_broken(report, maker, o);
    write_json(json, a, report);
    ok = ok && report.ok();
  }
  if (!a.json.empty()) {
    const std::string text = json.end().text();
    AtomicFile out(a.json);
    out.append(text.data(), text.size());
    out.commit();
  }
  return ok ? kOk : kFailed;
}

}  // namespace brume::cli
