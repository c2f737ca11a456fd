// The experiment file: one research question as TOML. Scenes, methods, seeds and swept settings span a product, and a
// run is one point of it.
//
//     title = "Which alpha is best for a Cornell box?"
//     scenes = [{ path = "../scenes/cornell-box/scene.xml", reference = "../reference/cornell-box" }]
//     seeds = 4                      # 1 to 4; or a list
//     passes = 64
//     record = "powers-of-two"       # or "all", or a list; pass 0 and the last are always recorded
//
//     [[method]]
//     integrator = "ppm"
//     alpha = [0.5, 0.7, 0.9]        # an axis
//
// Settings of methods at the top level are defaults for every method that uses them. Paths are relative to the file.

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiment/settings_io.h"
#include "scene/scene.h"

namespace photonlab {

struct SceneEntry {
    std::filesystem::path file;
    std::string name;                                ///< of the scene's folder, or of the file if that is not scene.xml
    std::optional<std::filesystem::path> reference;  ///< folder of halves, or an EXR; without one no errors are taken
    std::optional<Resolution> resolution;            ///< in place of the scene file's
};

/// One point of the product.
struct ExperimentRun {
    std::string name;       ///< unique and fit for a file: scene, method, what is swept, seed
    std::size_t scene = 0;  ///< index into Experiment::scenes
    std::string method;     ///< the name its method was given
    ChosenSettings settings;
    std::uint64_t seed = 1;
};

struct Experiment {
    std::filesystem::path file;
    std::string name;  ///< of the file, without .toml
    std::string title;
    std::vector<SceneEntry> scenes;
    std::vector<ExperimentRun> runs;  ///< scene by scene
    std::uint64_t passes = 1;
    std::vector<std::uint64_t> recorded;   ///< increasing; always with 0 and the last pass
    std::vector<std::uint64_t> snapshots;  ///< passes whose image is kept: increasing, always with the last
    int samples_per_pixel = 1;             ///< a perfect square
    int threads = 1;
};

/// What `photonlab run --smoke` shrinks an experiment to, so that all of it runs in seconds.
struct SmokeLimits {
    std::uint64_t passes = 4;
    std::uint64_t photons_per_pass = 2000;
    std::size_t seeds = 2;
};

/// Reads and checks everything that can be checked without the scenes. Throws InputError with file and line.
Experiment read_experiment(const std::filesystem::path& file, std::optional<SmokeLimits> smoke = std::nullopt);

/// Passes 0, 1, 2, 4, ... and the last.
std::vector<std::uint64_t> powers_of_two(std::uint64_t passes);

/// Threads that the machine can run at once.
int hardware_threads();

/// Throws InputError unless `samples_per_pixel` is the square of a whole number, at most 1024^2.
void require_perfect_square(std::int64_t samples_per_pixel);

}  // namespace photonlab
