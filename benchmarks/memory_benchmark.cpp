// How much memory a volume takes: the growth of a process that loads 512^3 samples of uint8 and
// touches them, at its peak and afterwards, over the bytes of the samples.
#include <benchmark/benchmark.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>

#include "palpate/proxy.hpp"
#include "palpate/scenes/volumes.hpp"

#ifdef PALPATE_IO_HELPER
#include <filesystem>

#include "palpate/io/volume_file.hpp"
#endif

namespace palpate::benchmarks {
namespace {

constexpr int edge = 512;
constexpr double sample_bytes = double(edge) * edge * edge;

/// VmHWM (peak) or VmRSS (now) of this process [bytes]; 0 where the system does not tell.
double memory(const std::string& what) {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
        double kibibytes = 0;
        if (word == what + ":" && status >> kibibytes) return kibibytes * 1024;
    }
    return 0;
}

/// Growth of memory over the samples, at its peak and at the end.
using Growth = std::array<double, 2>;

template <class Load>
Growth growth_here(Load&& load) {
    const double before = memory("VmRSS");
    try {
        const Volume volume = load();
        const Field field = linear_field(volume);
        double sum = 0;  // every page of the samples
        for (std::size_t i = 0; i < volume.bytes(); i += 512) {
            sum += static_cast<const std::uint8_t*>(volume.data())[i];
        }
        benchmark::DoNotOptimize(sum);
        return {(memory("VmHWM") - before) / sample_bytes,
                (memory("VmRSS") - before) / sample_bytes};
    } catch (const std::exception& error) {
        std::fprintf(stderr, "memory: %s\n", error.what());
        return {};
    }
}

/// In a process of its own, whose peak nothing else has raised.
template <class Load>
Growth growth_of(Load&& load) {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) return {};
    const pid_t child = fork();
    if (child == 0) {
        const Growth growth = growth_here(load);
        const bool sent = write(ends[1], growth.data(), sizeof growth) == sizeof growth;
        _exit(sent ? 0 : 1);
    }
    Growth growth{};
    close(ends[1]);
    if (child > 0) {
        if (read(ends[0], growth.data(), sizeof growth) != sizeof growth) growth = {};
        waitpid(child, nullptr, 0);
    }
    close(ends[0]);
    return growth;
}

void report(benchmark::State& state, const Growth& growth) {
    if (growth[1] == 0) return state.SkipWithError("nothing was loaded");
    state.counters["peak_over_samples"] = growth[0];
    state.counters["loaded_over_samples"] = growth[1];
}

Geometry geometry() {
    return scenes::centred(Index3::Constant(edge));
}

void taken_over(benchmark::State& state) {
    Growth growth{};
    for (auto _ : state) {
        growth = growth_of([] {
            std::vector<std::uint8_t> samples(static_cast<std::size_t>(sample_bytes), 1);
            return Volume(geometry(), std::move(samples));
        });
    }
    report(state, growth);
}
BENCHMARK(taken_over)->Name("memory/samples_taken_over")->Unit(benchmark::kMillisecond);

#ifdef PALPATE_IO_HELPER
void read_from_file(benchmark::State& state) {
    const auto folder =
        std::filesystem::temp_directory_path() / ("palpate-memory-" + std::to_string(getpid()));
    std::filesystem::create_directory(folder);
    const auto header = folder / "cube.nhdr";
    std::ofstream(header) << "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 512 512 512\n"
                             "spacings: 1 1 1\nencoding: raw\ndata file: cube.raw\n";
    {
        std::ofstream raw(folder / "cube.raw", std::ios::binary);
        const std::string slice(std::size_t{edge} * edge, '\1');
        for (int k = 0; k < edge; ++k) raw << slice;
    }
    Growth growth{};
    io::ReadOptions options;
    options.helper = PALPATE_IO_HELPER;
    for (auto _ : state) {
        growth = growth_of([&] { return io::read_volume(header, options).volume; });
    }
    report(state, growth);
    std::filesystem::remove_all(folder);
}
BENCHMARK(read_from_file)->Name("memory/read_from_file")->Unit(benchmark::kMillisecond);
#endif

}  // namespace
}  // namespace palpate::benchmarks
