// Path tracing from the hit points: one path at each in every pass. Unbiased, free of photons and radii, and so the
// independent method by which the others are judged; references are made with it.
//
// At each vertex light is found twice, by a connection to a point on a light and by the direction that continues the
// path, and the two are weighted by the balance heuristic: with densities p and q per steradian, w_p = p / (p + q).
//
// [Kajiya 1986, "The Rendering Equation"; Veach & Guibas 1995, "Optimally Combining Sampling Techniques"]

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/parallel.h"
#include "integrators/layers.h"
#include "integrators/registry.h"
#include "scene/emitter.h"
#include "transport/direct_light.h"
#include "transport/path_length.h"

namespace photonlab {

namespace {

constexpr std::uint32_t roulette_after = 3;  // bounces: most paths of a bright scene matter until then

/// What one path found: light reflected once at the hit point, and light reflected there after other reflections.
struct PathSample {
    ColorD direct = ColorD(0.0);
    ColorD gathered = ColorD(0.0);
};

/// Density per steradian with which connect_to_light() draws the light that was found in `direction`.
double connection_density(const Scene& scene, const Surface& surface, const Vector& direction,
                          const std::optional<Hit>& hit) {
    const std::uint32_t light = hit ? scene.shapes[hit->shape].emitter : *scene.environment;
    const double density =
        hit ? direct_density(scene, surface.position, direction, *hit) : escaped_density(scene, direction);
    return scene.emitters[light].choice_probability * density;
}

PathSample trace_path(const Scene& scene, const HitPoint& point, int max_depth, RandomStream& random) {
    PathSample result;
    Surface surface = surface_at(scene, point);
    Vector outgoing = point.outgoing;
    Color throughput(1.0f);

    for (std::uint32_t reflections = 1;; ++reflections) {
        // Light found from here has one edge more than the path so far: camera_edges + reflections in all.
        if (!depth_allows(max_depth, point.camera_edges + reflections)) break;
        ColorD& layer = reflections == 1 ? result.direct : result.gathered;

        if (is_scattering(surface.bsdf)) {
            if (const auto light = connect_to_light(scene, surface, outgoing, random)) {
                const double weight = light->light_density > 0.0
                                          ? light->light_density / (light->light_density + light->bsdf_density)
                                          : 1.0;
                layer += ColorD(throughput) * light->contribution * weight;
            }
        }

        const auto bounce = sample(surface.bsdf, surface.frame.to_local(outgoing), Carried::Radiance, random.next_2d());
        const float survival_draw = random.next();
        if (!bounce) break;
        // Of a hit point's single directions the camera pass has followed each.
        if (reflections == 1 && bounce->density == 0.0f) break;
        const Vector direction = surface.frame.to_world(bounce->incoming);
        if (!sides_agree(surface, direction)) break;
        throughput *= bounce->weight;

        const auto hit =
            intersect(scene, {offset_from_surface(surface.position, surface.geometric_normal, direction), direction});
        const ColorD emitted = hit ? emitted_radiance(scene, *hit, -direction) : escaped_radiance(scene, direction);
        if (!is_black(emitted)) {
            double weight = 1.0;  // of a specular direction: connecting to the light cannot find it
            if (bounce->density > 0.0f)
                weight = bounce->density / (bounce->density + connection_density(scene, surface, direction, hit));
            layer += ColorD(throughput) * emitted * weight;
        }
        if (!hit) break;

        if (reflections >= roulette_after) {
            const float survival = std::min(max_channel(throughput), highest_survival);
            if (survival_draw >= survival) break;
            throughput /= survival;
        }
        const auto next = orient(scene, *hit, -direction);
        if (!next) break;
        surface = *next;
        outgoing = -direction;
    }
    return result;
}

/// Light of what has no size that reaches a diffuse surface by a mirror or through glass is found by photons alone: a
/// path from the camera would have to hit a point, or the one direction.
void require_findable_light(const Scene& scene, int max_depth) {
    const auto hidden = std::find_if_not(scene.emitters.begin(), scene.emitters.end(), is_met_by_rays);
    if (hidden == scene.emitters.end() || !depth_allows(max_depth, 3)) return;
    for (const Shape& shape : scene.shapes) {
        const Material& material = scene.materials[shape.material];
        if (may_be_specular(material))
            throw InputError(scene.name,
                             fmt::format("cannot be path traced: it has a {} light and a {} (\"{}\"), and no path "
                                         "from the camera can find light without size by a mirror or through glass, "
                                         "so all its caustics would be missing; use ppm, also for a reference",
                                         emitter_kind(*hidden), material_kind(material), material.id));
    }
}

class PathTracing : public Integrator {
public:
    PathTracing(const MethodSettings& settings, const IntegratorContext& context)
        : max_depth_(settings.max_depth),
          context_(context),
          has_new_points_(settings.positions == Positions::Box),
          sums_(has_new_points_ ? pixel_count(context.hit_points) : context.hit_points.points.size()) {
        require_findable_light(context.scene, max_depth_);
    }

    void take(const Pass& pass) override {
        if (has_new_points_) {
            std::vector<PathSample> of_pass(pass.points.points.size());
            add_paths(pass.number, pass.points, of_pass);
            add_to_pixels(pass.points.points, of_pass);
        } else {
            add_paths(pass.number, pass.points, sums_);
        }
        ++passes_;
    }

    MethodLayers image(const PhotonsOfAllPasses*) override {
        const double share = 1.0 / static_cast<double>(passes_);
        if (passes_ > 0) return has_new_points_ ? layers_of_pixels(share) : layers_of(sums_, share, true);
        std::vector<PathSample> once(context_.hit_points.points.size());
        add_paths(0, context_.hit_points, once);
        return layers_of(once, 1.0, false);
    }

    IntegratorReport report() const override { return {.bytes = sums_.size() * sizeof(PathSample)}; }

    void exchange(StateArchive& archive) override {
        archive.exchange(passes_);
        archive.exchange_as_many(sums_);
    }

private:
    void add_paths(std::uint64_t pass, const HitPoints& hit_points, std::vector<PathSample>& sums) const {
        const HitPointList& points = hit_points.points;
        parallel_for(block_count(points.size(), hit_points_per_block), context_.threads, [&](std::size_t block) {
            const BlockRange range = block_range(block, points.size(), hit_points_per_block);
            RandomStreams streams(context_.seed, context_.path_purpose, pass);
            for (std::size_t i = range.begin; i < range.end; ++i) {
                RandomStream random = streams[i];
                const PathSample path = trace_path(context_.scene, points[i], max_depth_, random);
                sums[i].direct += path.direct;
                sums[i].gathered += path.gathered;
            }
        });
    }

    MethodLayers layers_of(const std::vector<PathSample>& sums, double scale, bool with_gathered) const {
        return {.gathered = to_pixels(
                    context_.hit_points, [&](std::size_t i) { return with_gathered ? sums[i].gathered : ColorD(0.0); },
                    scale),
                .direct = to_pixels(
                    context_.hit_points, [&](std::size_t i) { return sums[i].direct; }, scale)};
    }

    void add_to_pixels(const HitPointList& points, const std::vector<PathSample>& paths) {
        for (std::size_t i = 0; i < paths.size(); ++i) {
            const HitPoint point = points[i];
            sums_[point.pixel].direct += paths[i].direct * ColorD(point.weight);
            sums_[point.pixel].gathered += paths[i].gathered * ColorD(point.weight);
        }
    }

    MethodLayers layers_of_pixels(double scale) const {
        MethodLayers layers;
        for (const PathSample& sum : sums_) {
            layers.gathered.push_back(Color(sum.gathered * scale));
            layers.direct.push_back(Color(sum.direct * scale));
        }
        return layers;
    }

    const int max_depth_;
    const IntegratorContext context_;
    const bool has_new_points_;     // in every pass
    std::vector<PathSample> sums_;  // over passes: one a hit point, or one a pixel where points are new
    std::uint64_t passes_ = 0;
};

}  // namespace

IntegratorKind path_kind() {
    return {.name = "path",
            .label = "path tracing",
            .paper = "Kajiya 1986, with next-event estimation and multiple importance sampling",
            .needs =
                [](const MethodSettings& settings) {
                    Needs needs{.direct = Needs::Direct::ByItself, .passes = Needs::Passes::Independent};
                    if (settings.positions == Positions::Box)
                        needs.new_points = NewPoints{.positions = Positions::Box, .all_cells = true};
                    return needs;
                },
            .settings = {"positions", "max_depth", "branch_cutoff"},
            .make = make_integrator_of<PathTracing>};
}

}  // namespace photonlab
