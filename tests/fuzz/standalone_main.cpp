// SPDX-License-Identifier: Apache-2.0
// Replays a corpus folder and random mutations of it through LLVMFuzzerTestOneInput, without libFuzzer. Prints the
// seed, which differs in every run; FOURDVT_FUZZ_SEED=N repeats one. Usage: NAME_fuzz CORPUS_FOLDER [mutations per
// file, default 400]
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace {

std::vector<uint8_t> mutate(std::vector<uint8_t> bytes, std::mt19937& random) {
  const int edits = 1 + static_cast<int>(random() % 6);
  for (int i = 0; i < edits && !bytes.empty(); ++i) {
    const size_t at = random() % bytes.size();
    switch (random() % 5) {
      case 0:
        bytes[at] = static_cast<uint8_t>(random());
        break;
      case 1:
        bytes[at] ^= static_cast<uint8_t>(1u << (random() % 8));
        break;
      case 2:
        bytes.resize(at);
        break;
      case 3:
        bytes.insert(bytes.begin() + static_cast<long>(at), static_cast<uint8_t>(random()));
        break;
      default:
        for (size_t k = at; k < bytes.size() && k < at + 4; ++k) bytes[k] = 0xff;
    }
  }
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: %s CORPUS_FOLDER [MUTATIONS]\n", argv[0]), 2;
  const int mutations = argc > 2 ? std::atoi(argv[2]) : 400;
  const char* const wanted = std::getenv("FOURDVT_FUZZ_SEED");
  const unsigned seed_of_run = wanted ? unsigned(std::strtoul(wanted, nullptr, 10)) : std::random_device()();
  std::printf("seed %u\n", seed_of_run);
  std::fflush(stdout);
  std::mt19937 random(seed_of_run);
  size_t files = 0, runs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(argv[1])) {
    std::ifstream in(entry.path(), std::ios::binary);
    const std::vector<uint8_t> seed((std::istreambuf_iterator<char>(in)), {});
    LLVMFuzzerTestOneInput(seed.data(), seed.size());
    for (int i = 0; i < mutations; ++i, ++runs) {
      const std::vector<uint8_t> input = mutate(seed, random);
      LLVMFuzzerTestOneInput(input.data(), input.size());
    }
    ++files;
  }
  std::printf("%zu corpus files, %zu mutations\n", files, runs);
  return files > 0 ? 0 : 1;
}
