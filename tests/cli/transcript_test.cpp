// Runs the transcripts (README.md) and compares, line by line.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace {
namespace fs = std::filesystem;
using Lines = std::vector<std::string>;

struct Step {
  int line = 0;
  std::string command;
  Lines out, err;
  int code = 0;
};

std::vector<Step> read_steps(const fs::path& file) {
  std::vector<Step> steps;
  std::ifstream in(file);
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.starts_with("#")) continue;
    if (line.starts_with("$ ")) {
      steps.push_back({number, line.substr(2), {}, {}, 0});
      continue;
    }
    if (steps.empty()) continue;
    Step& step = steps.back();
    if (line.starts_with("> "))  // the command goes on
      step.command += "\n" + line.substr(2);
    else if (line.starts_with("! "))
      step.err.push_back(line.substr(2));
    else if (line.size() > 2 && line.front() == '[' && line.back() == ']' &&
             std::all_of(line.begin() + 1, line.end() - 1, ::isdigit))
      step.code = std::stoi(line.substr(1));
    else
      step.out.push_back(line);
  }
  for (Step& step : steps)
    while (!step.out.empty() && step.out.back().empty()) step.out.pop_back();
  return steps;
}

// "..." stands for any text.
bool matches(const std::string& pattern, const std::string& text, std::size_t p = 0,
             std::size_t t = 0) {
  const std::size_t dots = pattern.find("...", p);
  if (dots == std::string::npos)
    return text.compare(t, std::string::npos, pattern, p) == 0;
  if (text.compare(t, dots - p, pattern, p, dots - p) != 0) return false;
  for (std::size_t at = t + (dots - p); at <= text.size(); ++at)
    if (matches(pattern, text, dots + 3, at)) return true;
  return false;
}

// A line "..." stands for any lines.
bool match_lines(const Lines& expected, const Lines& found, std::size_t e = 0,
                 std::size_t f = 0) {
  for (; e < expected.size(); ++e, ++f) {
    if (expected[e] == "...") {
      for (std::size_t at = f; at <= found.size(); ++at)
        if (match_lines(expected, found, e + 1, at)) return true;
      return false;
    }
    if (f >= found.size() || !matches(expected[e], found[f])) return false;
  }
  return f == found.size();
}

Lines lines_of(const fs::path& file) {
  Lines lines;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  while (!lines.empty() && lines.back().empty()) lines.pop_back();
  return lines;
}

std::string joined(const Lines& lines, const char* mark) {
  std::string text;
  for (const std::string& line : lines) text += mark + line + "\n";
  return text;
}

// The exit code of the command; 128 + signal where one ended it.
int run(const std::string& command, const fs::path& folder, const fs::path& out,
        const fs::path& err) {
  const pid_t child = ::fork();
  if (child == 0) {
    const auto to = [](int fd, const fs::path& file, int flags) {
      const int opened = ::open(file.c_str(), flags, 0600);
      ::dup2(opened, fd);
      ::close(opened);
    };
    to(0, "/dev/null", O_RDONLY);
    to(1, out, O_WRONLY | O_CREAT | O_TRUNC);
    to(2, err, O_WRONLY | O_CREAT | O_TRUNC);
    if (::chdir(folder.c_str()) == 0)
      ::execl("/bin/bash", "bash", "-c", command.c_str(), nullptr);
    ::_exit(126);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

class Transcript : public testing::Test {
 public:
  explicit Transcript(fs::path file) : file_(std::move(file)) {}

  void TestBody() override {
    char name[] = "/tmp/brume_cli.XXXXXX";
    const fs::path base = ::mkdtemp(name), folder = base / "work";
    fs::create_directory(folder);
    const std::vector<Step> steps = read_steps(file_);
    EXPECT_FALSE(steps.empty()) << "a transcript without commands";
    for (const Step& step : steps) {
      const int code = run(step.command, folder, base / "out", base / "err");
      const Lines out = lines_of(base / "out"), err = lines_of(base / "err");
      EXPECT_TRUE(code == step.code && match_lines(step.out, out) &&
                  match_lines(step.err, err))
          << file_.string() << ":" << step.line << ": $ " << step.command
          << "\n--- expected\n"
          << joined(step.out, "") << joined(step.err, "! ") << "[" << step.code
          << "]\n--- found\n"
          << joined(out, "") << joined(err, "! ") << "[" << code << "]";
    }
    // A folder without rights (a test of refusals) must not stay.
    std::error_code ignored;
    fs::permissions(folder, fs::perms::owner_all, ignored);
    fs::remove_all(base, ignored);
  }

 private:
  fs::path file_;
};

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const std::string path = std::getenv("PATH") ? std::getenv("PATH") : "/usr/bin:/bin";
  ::setenv("PATH", (std::string(BRUME_BUILD_DIR) + ":" + path).c_str(), 1);
  ::setenv("DATA", BRUME_SOURCE_DIR "/data", 1);
  ::setenv("LC_ALL", "C.UTF-8", 1);
  for (const char* name : {"BRUME_THREADS", "BRUME_PLUGIN_PATH", "BRUME_ISA"})
    ::unsetenv(name);
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(BRUME_SOURCE_DIR "/tests/cli"))
    if (entry.path().extension() == ".t" && entry.path().stem() != BRUME_WITHOUT)
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files)
    testing::RegisterTest("transcript", file.stem().c_str(), nullptr, nullptr,
                          file.c_str(), 1, [file] { return new Transcript(file); });
  return RUN_ALL_TESTS();
}
