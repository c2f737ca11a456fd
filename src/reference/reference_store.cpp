#include "reference/reference_store.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <variant>

#include "core/error.h"
#include "core/files/file_lock.h"
#include "core/files/files.h"
#include "core/hash.h"
#include "core/machine/version.h"
#include "core/text/number_in.h"
#include "image/exr.h"
#include "reference/reference_check.h"
#include "render/estimates/memory.h"
#include "render/pass_loop.h"

namespace photonlab {

namespace {

constexpr std::uintmax_t largest_json = std::uintmax_t{1} << 24;  // bytes
constexpr std::string_view half_names[] = {"half_a", "half_b"};
constexpr std::string_view key_attribute = "photonlab.key";
constexpr std::string_view seed_attribute = "photonlab.seed";
constexpr std::string_view samples_attribute = "photonlab.samples";
constexpr std::string_view method_attribute = "photonlab.method";

/// The random streams of one half.
struct HalfPurposes {
    std::string_view name;
    LoopPurposes purposes;
};

constexpr HalfPurposes half_purposes[] = {{half_names[0],
                                           {RandomPurpose::ReferenceHalfA, RandomPurpose::ReferencePhotonsA,
                                            RandomPurpose::ReferenceDirectA, RandomPurpose::ReferencePositionsA}},
                                          {half_names[1],
                                           {RandomPurpose::ReferenceHalfB, RandomPurpose::ReferencePhotonsB,
                                            RandomPurpose::ReferenceDirectB, RandomPurpose::ReferencePositionsB}}};

/// How the samples are made, in words that tell whether others can be joined to them.
std::string describe_method(const MethodSettings& method) {
    if (method.integrator == "path") return "path";
    return fmt::format("ppm, knaus-zwicker, alpha {}, initial radius {} footprints, {} photons a pass", method.alpha,
                       method.footprints, method.photons_per_pass);
}

}  // namespace

MethodSettings reference_method(const ReferenceSettings& settings) {
    if (settings.integrator != "path" && settings.integrator != "ppm")
        throw InputError(
            fmt::format("integrator: expected path or ppm for a reference, got \"{}\"", settings.integrator));
    MethodSettings method;
    if (settings.positions != limit_of(settings.positions))
        throw InputError(
            fmt::format("positions: expected grid or box, to which {} converges", name_of(settings.positions)));
    if (settings.positions == Positions::Box && settings.integrator != "path")
        throw InputError("positions: box is known to references made by path alone");
    method.integrator = settings.integrator;
    method.positions = settings.positions;
    method.schedule = ScheduleName::KnausZwicker;
    method.alpha = settings.alpha;
    method.footprints = reference_footprints;
    method.area = AreaMode::Disc;  // its halves would share the lines by which areas are measured, with all they judge
    method.photons_per_pass = settings.photons_per_pass;
    method.max_depth = settings.max_depth;
    require_valid(method);
    return method;
}

namespace {

std::filesystem::path half_file(const std::filesystem::path& folder, std::string_view half) {
    return folder / (std::string(half) + ".exr");
}

std::uint64_t read_number(const std::filesystem::path& file, const Metadata& metadata, std::string_view attribute) {
    const auto found = metadata.find(std::string(attribute));
    const auto number = number_in<std::uint64_t>(found == metadata.end() ? std::string_view() : found->second);
    if (!number)
        throw InputError(file.string(),
                         fmt::format("this is no half of a reference: its attribute {} is not a number", attribute));
    return *number;
}

double stored_seconds(const std::filesystem::path& folder) {
    return is_there(folder / "reference.json") ? read_reference_json(folder).value("seconds", 0.0) : 0.0;
}

/// How many samples a half has, by its metadata. Throws InputError when others cannot be joined to them.
std::uint64_t samples_to_continue(const std::filesystem::path& file, const Metadata& metadata, const std::string& key,
                                  const RunSettings& settings) {
    const auto text = [&](std::string_view attribute, const std::string& otherwise) {
        const auto found = metadata.find(std::string(attribute));
        return found == metadata.end() ? otherwise : found->second;
    };
    if (text(key_attribute, "") != key)
        throw InputError(file.string(),
                         "this is a half of another reference: its scene, resolution, samples per pixel or depth "
                         "differ; choose another folder");
    const std::uint64_t seed = read_number(file, metadata, seed_attribute);
    if (seed != settings.seed)
        throw InputError(file.string(), fmt::format("was made with seed {}; it cannot be continued with seed {}", seed,
                                                    settings.seed));
    const std::string method = text(method_attribute, "path");
    if (method != describe_method(settings.method))
        throw InputError(file.string(), fmt::format("was made with {}; it cannot be continued with {}", method,
                                                    describe_method(settings.method)));
    return read_number(file, metadata, samples_attribute);
}

/// Refuses a folder of something else before anything is written into it.
void require_own_reference(const std::filesystem::path& folder, const std::string& key, const RunSettings& settings) {
    stored_seconds(folder);
    for (const std::string_view half : half_names) {
        const std::filesystem::path file = half_file(folder, half);
        if (is_there(file)) samples_to_continue(file, read_exr_metadata(file), key, settings);
    }
}

/// Replaces the file of a half; returns its checksum.
std::string save_half(const std::filesystem::path& file, const Image& image, const std::string& key,
                      const RunSettings& settings, std::uint64_t samples) {
    write_exr(file, image,
              {{std::string(key_attribute), key},
               {std::string(seed_attribute), std::to_string(settings.seed)},
               {std::string(method_attribute), describe_method(settings.method)},
               {std::string(samples_attribute), std::to_string(samples)}},
              ExrCompression::Small);
    return hash_file(file);
}

/// One half while samples are added: what was there, and an integrator that makes what is new.
class GrowingHalf {
public:
    GrowingHalf(std::filesystem::path file, const std::string& key, const Scene& scene, const HitPoints& hit_points,
                const RunSettings& settings, const LoopPurposes& purposes)
        : file_(std::move(file)), loop_(scene, hit_points, {settings}, purposes) {
        if (!is_there(file_)) return;
        Metadata metadata;
        stored_ = read_exr(file_, &metadata);
        stored_samples_ = samples_to_continue(file_, metadata, key, settings);
        if (!stored_.find(gathered_layer))
            throw InputError(file_.string(), "holds the picture without its layers; nothing can be added to it");
    }

    std::uint64_t samples() const { return stored_samples_ + new_samples_; }

    void add_sample() {
        ++new_samples_;
        loop_.take(samples());
    }

    /// Mean over old and new samples, in double until it is stored.
    Image mean() {
        if (new_samples_ == 0) return stored_;
        Image image = loop_.image();
        if (stored_samples_ == 0) return image;
        const double share = static_cast<double>(new_samples_) / static_cast<double>(samples());
        for (Layer& layer : image.layers) {
            const std::vector<Color>& stored = *stored_.find(layer.name);
            for (std::size_t i = 0; i < layer.pixels.size(); ++i)
                layer.pixels[i] = Color(ColorD(stored[i]) * (1.0 - share) + ColorD(layer.pixels[i]) * share);
        }
        return image;
    }

private:
    const std::filesystem::path file_;
    PassLoop loop_;
    Image stored_;
    std::uint64_t stored_samples_ = 0;
    std::uint64_t new_samples_ = 0;
};

/// Mean (A-B)^2 / 4 of the whole and of each layer.
Json noise_floor(const Image& half_a, const Image& half_b) {
    Reference reference;
    reference.half_a = half_a;
    reference.half_b = half_b;
    Json floor = Json::object();
    for (const std::string& component : components) {
        const auto errors = judge(half_a, reference, component, false);
        floor[component] = errors ? Json(errors->of("reference_floor").value_or(0.0)) : Json();
    }
    return floor;
}

/// The sum of the layers, as the only one.
Image picture_of(const Image& image) {
    const std::vector<ColorD> sum = total(image);
    return {image.width, image.height, {{std::string(total_component), {sum.begin(), sum.end()}}}};
}

/// What photons say of the light that a reference of so many paths shows, or, in words, why they were not asked.
std::variant<LightByPhotons, std::string> ask_photons(const Scene& scene, const HitPoints& hit_points,
                                                      const ReferenceSettings& settings, std::uint64_t paths) {
    if (settings.integrator != "path") return "it is made by photons itself";
    if (settings.positions == Positions::Box)
        return "its positions are anywhere in the pixels, those of photons would be a grid";
    if (scene.emitters.empty()) return "there is no light";
    if (hit_points.points.empty()) return "there is no surface to gather at in the picture";
    const auto answer = measure_light_by_photons(
        scene, hit_points, {paths, settings.max_depth, settings.seed, settings.threads, settings.is_interrupted});
    if (!answer) return "it was interrupted";
    return *answer;
}

Json check_of(const std::variant<LightByPhotons, std::string>& photons, const Image& half_a, const Image& half_b) {
    const auto* light = std::get_if<LightByPhotons>(&photons);
    return light ? check_json(half_a, half_b, *light) : not_made(std::get<std::string>(photons));
}

ReferenceSubject subject_of(const Scene& scene, const ReferenceSettings& settings) {
    return {scene.hash,         scene.camera.width, scene.camera.height, settings.samples_per_pixel,
            settings.max_depth, settings.positions};
}

FileLock lock_reference(const std::filesystem::path& folder) {
    auto lock = FileLock::try_lock(folder / "lock");
    if (!lock) throw HeldElsewhere(folder.string(), "another process is adding samples to this reference");
    return std::move(*lock);
}

/// The part of reference.json that says what it is a reference of, and how it is made.
Json subject_json(const Scene& scene, const ReferenceSettings& settings) {
    const ReferenceSubject subject = subject_of(scene, settings);
    const MethodSettings method = reference_method(settings);
    return {{"schema", 1},
            {"key", reference_key(subject)},
            {"reference_version", reference_version},
            {"integrator", method.integrator},
            {"method", describe_method(method)},
            {"estimate", method.integrator == "path" ? "unbiased" : "consistent, not unbiased"},
            {"scene", {{"name", scene.name}, {"file", settings.scene_file.string()}, {"hash", scene.hash}}},
            {"width", subject.width},
            {"height", subject.height},
            {"samples_per_pixel", subject.samples_per_pixel},
            {"positions", name_of(subject.positions)},
            {"max_depth", subject.max_depth},
            {"seed", settings.seed}};
}

void set_check(Json& json, const Json& check) {
    json["check"] = check;
    if (json.value("integrator", "path") == "path")
        json["estimate"] = check.at("verdict") == "disputed" ? "unbiased, but disputed" : "unbiased";
}

/// The halves of a reference as they are written.
struct Halves {
    Image a;
    Image b;
    std::uint64_t samples = 0;  ///< in each
    double seconds = 0.0;       ///< that they took
};

/// Writes the halves and reference.json, last; returns what that says. `picture_only`: ReferenceSettings's.
Json write_reference(const Scene& scene, const ReferenceSettings& settings, const std::filesystem::path& folder,
                     Halves halves, const std::variant<LightByPhotons, std::string>& photons, bool picture_only) {
    const std::string key = reference_key(subject_of(scene, settings));
    const RunSettings run{.method = reference_method(settings), .seed = settings.seed};
    const Json check = check_of(photons, halves.a, halves.b);
    if (picture_only) {
        halves.a = picture_of(halves.a);
        halves.b = picture_of(halves.b);
    }
    const auto save = [&](std::string_view half, const Image& image) {
        return save_half(half_file(folder, half), image, key, run, halves.samples);
    };
    const std::string checksum_a = save(half_names[0], halves.a);
    const std::string checksum_b = save(half_names[1], halves.b);
    Json json = subject_json(scene, settings);
    json["samples_per_half"] = halves.samples;
    json["seconds"] = halves.seconds;
    json["floor_mse"] = noise_floor(halves.a, halves.b);
    set_check(json, check);
    json["checksums"] = {{"half_a", checksum_a}, {"half_b", checksum_b}};
    const ProgramVersion program = program_version();
    json["program"] = {{"version", program.version}, {"commit", program.commit}};
    write_text_file(folder / "reference.json", json_text(json) + "\n");
    return json;
}

double seconds_since(std::chrono::steady_clock::time_point then) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - then).count();
}

/// The loops of both halves, that make a part or join several.
struct HalfLoops {
    PassLoop a;
    PassLoop b;
    double seconds = 0.0;  // that the samples took

    HalfLoops(const Scene& scene, const HitPoints& hit_points, const RunSettings& run)
        : a(scene, hit_points, {run}, half_purposes[0].purposes),
          b(scene, hit_points, {run}, half_purposes[1].purposes) {}

    std::uint64_t last() const { return b.state(0).pass; }

    void exchange(StateArchive& archive) {
        a.exchange(0, archive);
        b.exchange(0, archive);
        archive.exchange_sum(seconds);
    }
};

}  // namespace

Json add_reference_samples(const Scene& scene, const ReferenceSettings& settings, const std::filesystem::path& folder,
                           const SampleListener& on_sample) {
    require_perfect_square(settings.samples_per_pixel);
    const std::string key = reference_key(subject_of(scene, settings));
    const MethodSettings method = reference_method(settings);
    const RunSettings run{.method = method, .seed = settings.seed, .threads = settings.threads};
    require_own_reference(folder, key, run);
    require_memory(folder.string(), MemoryEstimator(scene, settings.samples_per_pixel).of({run, run}, 0));
    require_writable(folder / "reference.json");
    const FileLock lock = lock_reference(folder);
    const double seconds_before = stored_seconds(folder);

    const HitPoints hit_points = trace_hit_points(scene, settings.samples_per_pixel, settings.threads);
    const auto half = [&](const HalfPurposes& of_half) {
        return GrowingHalf(half_file(folder, of_half.name), key, scene, hit_points, run, of_half.purposes);
    };
    GrowingHalf half_a = half(half_purposes[0]);
    GrowingHalf half_b = half(half_purposes[1]);

    const std::uint64_t target = std::max(half_a.samples(), half_b.samples()) + settings.samples;
    const auto photons = ask_photons(scene, hit_points, settings, 2 * target * hit_points.points.size());
    const auto began = std::chrono::steady_clock::now();

    Json json;
    const auto save = [&](bool picture_only) {
        json = write_reference(scene, settings, folder,
                               {half_a.mean(), half_b.mean(), half_a.samples(), seconds_before + seconds_since(began)},
                               photons, picture_only);
    };

    const std::uint64_t before = half_a.samples() + half_b.samples();
    const std::uint64_t to_do = 2 * target - before;
    auto saved = began;
    bool is_interrupted = false;
    while (!is_interrupted && (half_a.samples() < target || half_b.samples() < target)) {
        GrowingHalf& lagging = half_b.samples() < half_a.samples() ? half_b : half_a;
        lagging.add_sample();
        on_sample(half_a.samples() + half_b.samples() - before, to_do);
        const auto now = std::chrono::steady_clock::now();
        const bool is_time = std::chrono::duration<double>(now - saved).count() >= settings.seconds_between_saves;
        if (half_a.samples() != half_b.samples()) continue;
        is_interrupted = settings.is_interrupted();
        if (is_time && !is_interrupted) {
            save(false);
            saved = std::chrono::steady_clock::now();
        }
    }
    save(settings.picture_only && !is_interrupted);
    return json;
}

bool make_reference_part(const Scene& scene, const ReferenceSettings& settings, const PassRange& passes,
                         const Checkpoint& checkpoint, const SampleListener& on_sample) {
    require_perfect_square(settings.samples_per_pixel);
    const RunSettings run{.method = reference_method(settings), .seed = settings.seed, .threads = settings.threads};
    require_memory(checkpoint.file.string(), MemoryEstimator(scene, settings.samples_per_pixel).of({run, run}, 0));
    require_writable(checkpoint.file);
    const auto lock = FileLock::try_lock(checkpoint.file.string() + ".lock");
    if (!lock) throw HeldElsewhere(checkpoint.file.string(), "another process is making these samples");

    const HitPoints hit_points = trace_hit_points(scene, settings.samples_per_pixel, settings.threads);
    HalfLoops halves(scene, hit_points, run);
    const StateExchange state = [&](StateArchive& archive) { halves.exchange(archive); };
    const std::uint64_t before = load(checkpoint, state) ? halves.last() : passes.first - 1;
    const double seconds_before = halves.seconds;
    const auto began = std::chrono::steady_clock::now();
    CheckpointClock clock(settings.seconds_between_saves);
    bool is_interrupted = false;
    for (std::uint64_t pass = before + 1; pass <= passes.last && !is_interrupted; ++pass) {
        halves.a.take(pass);
        halves.b.take(pass);
        halves.seconds = seconds_before + seconds_since(began);
        on_sample(2 * (pass - passes.first + 1), 2 * passes.count());
        is_interrupted = pass < passes.last && settings.is_interrupted();
        if (pass < passes.last && !is_interrupted && !clock.is_due_after_pass()) continue;
        save(checkpoint, state);
        clock.saved();
    }
    return !is_interrupted;
}

Json join_reference_parts(const Scene& scene, const ReferenceSettings& settings,
                          const std::vector<ReferencePart>& parts, const std::filesystem::path& folder) {
    const RunSettings run{.method = reference_method(settings), .seed = settings.seed, .threads = settings.threads};
    require_own_reference(folder, reference_key(subject_of(scene, settings)), run);
    require_memory(folder.string(), MemoryEstimator(scene, settings.samples_per_pixel).of({run, run}, 0));
    require_writable(folder / "reference.json");
    const FileLock lock = lock_reference(folder);
    const std::uint64_t samples = parts.back().passes.last;
    if (is_there(folder / "reference.json"))
        if (const auto there = read_reference_json(folder).at("samples_per_half").get<std::uint64_t>(); there > samples)
            throw InputError(folder.string(), fmt::format("holds {} samples a half, and these parts {}: join them into "
                                                          "another folder",
                                                          there, samples));

    const HitPoints hit_points = trace_hit_points(scene, settings.samples_per_pixel, settings.threads);
    HalfLoops halves(scene, hit_points, run);
    for (const auto& [checkpoint, passes] : parts) {
        load(checkpoint, [&](StateArchive& archive) {
            if (halves.last() > 0) archive.begin_joining();
            halves.exchange(archive);
        });
        if (halves.last() != passes.last)
            throw InputError(checkpoint.file.string(),
                             fmt::format("has samples up to {} of {}; the same command makes the others", halves.last(),
                                         describe(passes)));
    }
    return write_reference(scene, settings, folder, {halves.a.image(), halves.b.image(), samples, halves.seconds},
                           ask_photons(scene, hit_points, settings, 2 * samples * hit_points.points.size()), false);
}

Json compare_reference_with_photons(const Scene& scene, const ReferenceSettings& settings,
                                    const std::filesystem::path& folder) {
    read_reference_json(folder);  // before there is a lock in a folder that is none
    const FileLock lock = lock_reference(folder);
    Json json = read_reference_json(folder);
    const Reference reference = load_reference(folder, subject_of(scene, settings));
    ReferenceSettings made = settings;
    made.integrator = json.value("integrator", "path");
    made.positions = parse_choice<Positions>("positions", json.value("positions", "grid"));
    made.seed = json.value("seed", settings.seed);
    const HitPoints hit_points = trace_hit_points(scene, settings.samples_per_pixel, settings.threads);
    const std::uint64_t samples = json.at("samples_per_half").get<std::uint64_t>();
    const auto photons = ask_photons(scene, hit_points, made, 2 * samples * hit_points.points.size());
    if (settings.is_interrupted()) return json;
    set_check(json, reference.half_a.find(gathered_layer) ? check_of(photons, reference.half_a, reference.half_b)
                                                          : not_made("it holds the picture without its layers"));
    write_text_file(folder / "reference.json", json_text(json) + "\n");
    return json;
}

Json read_reference_json(const std::filesystem::path& folder) {
    const std::filesystem::path file = folder / "reference.json";
    const std::optional<std::string> text = read_if_there(file, largest_json);
    if (!text)
        throw InputError(folder.string(),
                         "this is no reference: reference.json is missing (photonlab reference makes one)");
    Json json;
    try {
        json = parse_json(*text);
    } catch (const InputError& error) {
        throw InputError(file.string(), std::string("this is no reference: ") + error.what());
    }
    try {
        json.at("scene").at("hash").get<std::string>();
        // Json turns any number into an int, whether it fits or not.
        const auto require_whole = [&](const char* name, std::int64_t least, std::int64_t most) {
            const Json& number = json.at(name);
            const bool fits = number.is_number_unsigned()
                                  ? number.get<std::uint64_t>() <= static_cast<std::uint64_t>(most)
                                  : number.is_number_integer();
            if (!fits || number.get<std::int64_t>() < least || number.get<std::int64_t>() > most)
                throw InputError(file.string(),
                                 fmt::format("{}: expected a whole number from {} to {}", name, least, most));
        };
        const auto require_not_negative = [&](const Json& number, const char* name) {
            if (!(number.get<double>() >= 0.0))
                throw InputError(file.string(), fmt::format("{}: expected a number of at least 0", name));
        };
        constexpr std::int64_t most = std::numeric_limits<int>::max();
        for (const char* name : {"width", "height", "samples_per_pixel"}) require_whole(name, 1, most);
        require_whole("max_depth", -1, most);
        require_whole("reference_version", 0, most);
        require_whole("samples_per_half", 1, std::numeric_limits<std::int64_t>::max());
        json.at("key").get<std::string>();
        if (json.contains("integrator")) json.at("integrator").get<std::string>();
        if (json.contains("positions")) parse_choice<Positions>("positions", json.at("positions").get<std::string>());
        if (json.contains("seed") && !json.at("seed").is_number_unsigned())
            throw InputError(file.string(), "seed: expected a whole number of at least 0");
        require_not_negative(json.at("floor_mse").at("total"), "floor_mse: total");
        if (json.contains("check"))
            for (const char* name : {"verdict", "why"}) json.at("check").at(name).get<std::string>();
        if (json.contains("seconds")) require_not_negative(json.at("seconds"), "seconds");
        for (const std::string_view half : half_names) json.at("checksums").at(std::string(half)).get<std::string>();
    } catch (const Json::exception& error) {
        throw InputError(file.string(), std::string("this is no reference: ") + error.what());
    }
    return json;
}

Image read_reference_half(const std::filesystem::path& folder, const Json& json, std::string_view half) {
    const std::filesystem::path file = half_file(folder, half);
    if (hash_file(file) != json.at("checksums").at(std::string(half)).get<std::string>())
        throw InputError(
            file.string(),
            "is not the file that reference.json was written for: it was changed, or a save was interrupted "
            "(photonlab reference with the same folder repairs the latter)");
    Image image = read_exr(file);
    if (image.width != json.at("width").get<int>() || image.height != json.at("height").get<int>())
        throw InputError(file.string(), "is not of the size that reference.json gives");
    return image;
}

}  // namespace photonlab
