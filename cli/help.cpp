#include <fmt/format.h>

#include <algorithm>

#include "arguments.h"

namespace brume::cli {

namespace {

const char* const kIntro =
    "brume gives a rendered frame its air: it reads colour and linear depth, lets light "
    "cross the atmosphere between every pixel and the lens, and writes the frame back.";

const std::pair<const char*, const char*> kExitCodes[] = {
    {"0", "all went well"},
    {"1", "it failed, and says why on standard error"},
    {"2", "the command line makes no sense"},
    {"3", "some frames failed, the others are written"},
    {"75", "the machine had no memory, threads or open files left: try again"},
    {"130", "interrupted (Ctrl-C, SIGTERM); every file written is whole"}};

const std::pair<const char*, const char*> kEnvironment[] = {
    {"BRUME_THREADS", "threads to use where --threads is not given"},
    {"BRUME_PLUGIN_PATH", "folders, separated by colons, searched first for stages"},
    {"BRUME_ISA", "v2, v3 or v4: use no more than this x86-64 instruction set"},
    {"BRUME_CACHE", "folder for tables kept between runs (~/.cache/brume), or off"},
    {"BRUME_UPLOT", "folder of uPlot for the pages of study, in place of its own"},
    {"NO_COLOR", "set to anything: messages without colour"}};

// Words of `text` in lines of at most `width`, each after the first indented.
std::string wrapped(const std::string& text, int indent, int width) {
  std::string out;
  int column = indent;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const int length = int(end - at);
    if (column > indent && column + 1 + length > width) {
      out += '\n' + std::string(std::size_t(indent), ' ');
      column = indent;
    } else if (column > indent) {
      out += ' ';
      ++column;
    }
    out += text.substr(at, end - at);
    column += length;
    at = end + 1;
  }
  return out;
}

// "-o, --output OUT".
std::string spelled(const OptionDoc& o) {
  std::string names = o.names;
  if (const auto comma = names.find(','); comma != std::string::npos)
    names.insert(comma + 1, " ");
  if (o.argument || o.value.empty()) return names;
  return names + " " + o.value;
}

std::string usage(const CommandDoc& doc) {
  std::string text = "brume " + doc.name;
  for (const OptionDoc& o : doc.options) {
    if (!o.argument) continue;
    std::string a = o.names + (o.repeats ? "..." : "");
    text += " " + (o.needed ? a : "[" + a + "]");
  }
  for (const OptionDoc& o : doc.options)
    if (o.names.starts_with("-o,") && o.needed) text += " -o " + o.value;
  return text + " [options]";
}

std::string described(const OptionDoc& o) {
  std::string text = o.text;
  if (!o.words.empty()) {
    text += ": ";
    for (std::size_t i = 0; i < o.words.size(); ++i) text += (i ? ", " : "") + o.words[i];
  }
  return text;
}

void row(std::string& out, const std::string& left, const std::string& right, int indent,
         int width) {
  out += "  " + left;
  const int used = 2 + int(left.size());
  if (used + 2 > indent)
    out += '\n' + std::string(std::size_t(indent), ' ');
  else
    out += std::string(std::size_t(indent - used), ' ');
  out += wrapped(right, indent, width) + '\n';
}

// roff's own characters.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
      continue;
    }
    if (c == '-') out += '\\';
    if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n')) out += "\\&";
    out += c;
  }
  return out;
}

}  // namespace

std::string help_text(std::span<const CommandDoc> docs, int columns) {
  const int width = std::clamp(columns, 60, 90);
  std::string out = wrapped(kIntro, 0, width) + "\n\nusage: brume COMMAND ...\n\n";
  for (const CommandDoc& d : docs) row(out, d.name, d.summary, 12, width);
  out += '\n';
  row(out, "brume COMMAND --help", "what a command takes, with examples", 28, width);
  row(out, "brume --version", "the version", 28, width);
  out += "\nExit codes\n";
  for (const auto& [code, text] : kExitCodes) row(out, code, text, 8, width);
  out += "\nEnvironment\n";
  for (const auto& [name, text] : kEnvironment) row(out, name, text, 24, width);
  return out;
}

std::string help_text(const CommandDoc& doc, int columns) {
  const int width = std::clamp(columns, 60, 90);
  std::string out =
      "usage: " + usage(doc) + "\n\n" + wrapped(doc.text, 0, width) + "\n\n";
  for (const bool arguments : {true, false}) {
    for (const OptionDoc& o : doc.options)
      if (o.argument == arguments) row(out, spelled(o), described(o), 26, width);
    out += '\n';
  }
  out += "Examples\n";
  for (const auto& [command, text] : doc.examples)
    out += "  " + command + "\n      " + wrapped(text, 6, width) + '\n';
  return out;
}

std::string man_page(std::span<const CommandDoc> docs) {
  std::string out = ".TH BRUME 1 \"\" \"brume " BRUME_VERSION "\" \"User Commands\"\n";
  out += ".SH NAME\nbrume \\- atmosphere for rendered frames\n.SH SYNOPSIS\n";
  for (const CommandDoc& d : docs) out += ".B " + roff(usage(d)) + "\n.br\n";
  out += ".SH DESCRIPTION\n" + roff(kIntro) + "\n";
  for (const CommandDoc& d : docs) {
    std::string title = "brume " + d.name;
    std::transform(title.begin(), title.end(), title.begin(), ::toupper);
    out += ".SH " + title + "\n" + roff(d.text) + "\n";
    for (const OptionDoc& o : d.options)
      out += ".TP\n.B " + roff(spelled(o)) + "\n" + roff(described(o)) + "\n";
    out += ".PP\nExamples:\n";
    for (const auto& [command, text] : d.examples)
      out += ".PP\n.nf\n.B " + roff(command) + "\n.fi\n.RS\n" + roff(text) + "\n.RE\n";
  }
  out += ".SH EXIT STATUS\n";
  for (const auto& [code, text] : kExitCodes)
    out += fmt::format(".TP\n.B {}\n{}\n", code, roff(text));
  out += ".SH ENVIRONMENT\n";
  for (const auto& [name, text] : kEnvironment)
    out += fmt::format(".TP\n.B {}\n{}\n", name, roff(text));
  return out;
}

std::string bash_completion(std::span<const CommandDoc> docs) {
  std::string names;
  for (const CommandDoc& d : docs) names += d.name + " ";
  std::string out =
      "# bash completion for brume, generated by `brume --completion`\n"
      "_brume() {\n"
      "  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]}\n"
      "  local command=${COMP_WORDS[1]} words=\n"
      "  COMPREPLY=()\n"
      "  if [ \"$COMP_CWORD\" = 1 ]; then\n"
      "    words=\"" +
      names +
      "--help --version\"\n"
      "  else\n"
      "    case $command in\n";
  for (const CommandDoc& d : docs) {
    out += "      " + d.name + ")\n        case $prev in\n";
    std::string flags;
    for (const OptionDoc& o : d.options) {
      if (o.argument) continue;
      std::string patterns = o.names;
      flags += o.names.substr(o.names.find("--")) + " ";
      if (const auto comma = patterns.find(','); comma != std::string::npos)
        patterns.replace(comma, 1, "|");
      if (o.words.empty()) continue;
      out += "          " + patterns + ") words=\"";
      for (const std::string& w : o.words) out += w + " ";
      out += "\" ;;\n";
    }
    if (d.name == "stages")  // its argument is a stage's name
      out += "          stages) [[ $cur == -* ]] && words=\"" + flags +
             "\" || words=$(brume stages --names 2>/dev/null) ;;\n";
    out +=
        "          *) [[ $cur == -* ]] && words=\"" + flags + "\" ;;\n        esac ;;\n";
  }
  out +=
      "    esac\n"
      "  fi\n"
      "  [ -n \"$words\" ] && COMPREPLY=($(compgen -W \"$words\" -- \"$cur\"))\n"
      "}\n"
      "complete -o default -F _brume brume\n";
  return out;
}

}  // namespace brume::cli
