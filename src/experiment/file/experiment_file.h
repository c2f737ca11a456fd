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
// `decomposition = true` keeps sums of images over seeds (ensemble.h), from which bias and variance are told apart; a
// scene's `regions = { caustic = [left, top, right, bottom] }` are then looked at apart from the whole image. Its
// `probes = { corner = [x, y] }` are pixels whose radius, photon count and radiance are recorded after every pass.
//
// Settings of methods at the top level are defaults for every method that uses them. Paths are relative to the file.

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "integrators/settings/chosen_settings.h"
#include "scene/scene.h"

namespace photonlab {

/// A named rectangle of pixels in which errors are studied apart: smooth light, edges, a caustic.
struct Region {
    std::string name;
    int left = 0, top = 0;      ///< first column and row, from 0; y from the top
    int right = 0, bottom = 0;  ///< one past the last
};

/// A named pixel whose gathering is recorded pass by pass.
struct Probe {
    std::string name;
    int x = 0, y = 0;  ///< from 0; y from the top
};

struct SceneEntry {
    std::filesystem::path file;
    std::string name;                                ///< of the scene's folder, or of the file if that is not scene.xml
    std::optional<std::filesystem::path> reference;  ///< folder of halves, or an EXR; without one no errors are taken
    std::optional<Resolution> resolution;            ///< in place of the scene file's
    int samples_per_pixel = 1;                       ///< a perfect square
    std::vector<Region> regions;
    std::vector<Probe> probes;
};

/// How many passes a run has, and which of them are looked at.
struct PassPlan {
    std::uint64_t passes = 1;
    std::vector<std::uint64_t> recorded;   ///< increasing; always with 0 and the last pass
    std::vector<std::uint64_t> snapshots;  ///< passes whose image is kept: increasing, always with the last
};

/// A point of the product without its seeds: what runs have in common that differ in their seed alone.
struct ExperimentPoint {
    std::string name;       ///< unique and fit for a file: scene, method, what is swept
    std::size_t scene = 0;  ///< index into Experiment::scenes
    std::string method;     ///< the name its method was given
    ChosenSettings settings;
    PassPlan plan;  ///< its method's, or the experiment's
};

/// A point with one of the seeds. The experiment's points must outlive it.
struct ExperimentRun {
    std::string name;  ///< unique and fit for a file: the point's, and the seed
    const ExperimentPoint* point = nullptr;
    std::uint64_t seed = 1;
    std::size_t seed_place = 0;  ///< of the seed among the experiment's, from 0
    std::size_t group = 1;       ///< its scene's and seed's, whose runs can share photons; from 1, scene by scene
};

/// Groups of an experiment, from 1.
struct GroupRange {
    std::size_t first = 1;
    std::size_t last = 1;  ///< not below the first
};

struct Experiment {
    std::filesystem::path file;
    std::string name;       ///< of the file, without .toml; with -smoke behind it when it is
    bool is_smoke = false;  ///< shrunk to SmokeLimits
    std::string title;
    std::vector<SceneEntry> scenes;
    std::vector<ExperimentPoint> points;  ///< scene by scene
    std::vector<std::uint64_t> seeds;
    int threads = 1;
    bool decomposition = false;  ///< keep sums over seeds, from which bias and variance are told apart

    std::size_t run_count() const { return points.size() * seeds.size(); }
    std::size_t group_count() const { return scenes.size() * seeds.size(); }
};

/// The runs of these groups, point by point; all where no groups are named. They are made when they are asked for, so
/// that one job of many pays for its own alone.
std::vector<ExperimentRun> runs_of(const Experiment& experiment, std::optional<GroupRange> groups = std::nullopt);

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

}  // namespace photonlab
