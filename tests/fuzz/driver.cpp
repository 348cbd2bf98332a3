/// Runs a fuzz target without libFuzzer: all files of the given folders, then mutations of them for some time or until
/// there have been so many.
///
///   fuzz_scene [--seconds N | --runs N] [--slow SECONDS] [--random N] FILE_OR_FOLDER...
///
/// The input that is being run is in the file `<program>.input` while it runs, so that a crash leaves it behind.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

namespace fs = std::filesystem;
using Bytes = std::string;
using Clock = std::chrono::steady_clock;

double slow_s = 20;  // libFuzzer's -timeout; far above what any input may take, even with sanitizers
constexpr std::size_t longest_input = 1 << 16;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

void run(const Bytes& input, const std::string& saved, const std::string& name) {
  std::ofstream(saved, std::ios::binary).write(input.data(), static_cast<std::streamsize>(input.size()));
  const auto start = Clock::now();
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
  if (seconds_since(start) < slow_s) return;
  std::fprintf(stderr, "%s took %.0f s; it is in %s\n", name.c_str(), seconds_since(start), saved.c_str());
  std::exit(1);
}

std::vector<Bytes> read_inputs(const std::vector<std::string>& paths) {
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    if (!fs::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    for (const fs::directory_entry& entry : fs::directory_iterator(path)) files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  std::vector<Bytes> inputs;
  for (const std::string& file : files) {
    std::ifstream stream(file, std::ios::binary);
    inputs.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
    if (!stream.is_open()) {
      std::fprintf(stderr, "%s cannot be read\n", file.c_str());
      std::exit(1);
    }
  }
  return inputs;
}

/// What parsers trip over.
const std::vector<Bytes> words = {"nan",
                                  "inf",
                                  "-1",
                                  "0",
                                  "1e308",
                                  "-1e-308",
                                  "99999999999",
                                  "1.5",
                                  "\n",
                                  "\"",
                                  "'''",
                                  "[",
                                  "]",
                                  "{",
                                  "}",
                                  "(",
                                  ")",
                                  "=",
                                  ".",
                                  ",",
                                  "#set ",
                                  "[[",
                                  "]]",
                                  Bytes(1, '\0'),
                                  "\xff\xff\xff\xff",
                                  "\x7f\xc0",
                                  "x",
                                  "/",
                                  "^",
                                  "?",
                                  ":",
                                  "1e5",
                                  "-"};

Bytes mutate(const std::vector<Bytes>& inputs, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  Bytes input = inputs[below(inputs.size())];
  for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
    const std::size_t place = below(input.size() + 1), length = std::min(input.size() - place, 1 + below(40));
    switch (below(6)) {
      case 0:
        input.erase(place, length);
        break;
      case 1:
        input.insert(place, words[below(words.size())]);
        break;
      case 2:
        input.insert(place, input.substr(place, length));
        break;
      case 3:
        input.replace(place, length, words[below(words.size())]);
        break;
      case 4:
        if (place < input.size()) input[place] = static_cast<char>(below(256));
        break;
      default: {
        const Bytes& other = inputs[below(inputs.size())];
        input.replace(place, length, other.substr(below(other.size() + 1), 1 + below(200)));
      }
    }
  }
  input.resize(std::min(input.size(), longest_input));
  return input;
}

}  // namespace

int main(int argc, char** argv) {
  double seconds = 0;
  long long runs = 0;
  unsigned start_value = 1;
  std::vector<std::string> paths;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "--seconds" && k + 1 < argc)
      seconds = std::atof(argv[++k]);
    else if (word == "--runs" && k + 1 < argc)
      runs = std::atoll(argv[++k]);
    else if (word == "--slow" && k + 1 < argc)
      slow_s = std::atof(argv[++k]);
    else if (word == "--random" && k + 1 < argc)
      start_value = static_cast<unsigned>(std::atoi(argv[++k]));
    else
      paths.push_back(word);
  }
  const std::vector<Bytes> inputs = read_inputs(paths);
  if (inputs.empty()) {
    std::fprintf(stderr, "usage: %s [--seconds N | --runs N] [--slow SECONDS] [--random N] FILE_OR_FOLDER...\n",
                 argv[0]);
    return 1;
  }
  const std::string saved = fs::path(argv[0]).filename().string() + ".input";
  for (const Bytes& input : inputs) run(input, saved, "a seed");
  std::mt19937 random(start_value);
  long long mutated = 0;
  for (const auto start = Clock::now(); mutated < runs || seconds_since(start) < seconds; ++mutated)
    run(mutate(inputs, random), saved, "a mutated input");
  fs::remove(saved);
  std::printf("%zu inputs and %lld mutations of them: no crash\n", inputs.size(), mutated);
}
