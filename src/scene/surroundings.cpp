#include "scene/surroundings.h"

#include "scene/circle_area.h"
#include "scene/embree_scene.h"

namespace photonlab {

namespace {

/// By how much float positions and normals may put a point off the plane that it lies in, unit box: some eight
/// roundings. Less than offset_from_surface() lifts it.
constexpr double flatness = 1e-6;

/// Where what stands on a plane hides what is behind: as high as points there are lifted.
constexpr double lifted = 32.0 * 0.5 * std::numeric_limits<float>::epsilon();

/// Of a disc's area: what is missing, or there twice, before it is not whole.
constexpr double whole_tolerance = 1e-4;

/// Cosines of shading normals that are, and that are not, within 60 degrees of the point's whatever photons make of
/// them, which keep them to a degree.
constexpr float surely_agree = 0.55f;
constexpr float surely_disagree = 0.45f;

enum class Acceptance { Everywhere, Nowhere, Unknown };

/// Analytic shapes that know of themselves where they are whole.
template <typename Kind>
concept KnowsItsWhole = requires(const Kind& shape, const Vector& position) {
    { shape.distance_to(position) } -> std::same_as<double>;
    { shape.whole_within(position, 0.0) } -> std::same_as<std::optional<Vector>>;
};

/// Sorts what is found in the ball, primitive by primitive.
class BallContent {
public:
    BallContent(const Scene& scene, const SurfaceEnd& point, double radius)
        : scene_(scene), point_(point), frame_(make_frame(point.geometric_normal)), radius_(radius) {}

    void add(std::uint32_t shape_index, std::uint32_t primitive) {
        if (!is_flat_) return;
        const Shape& shape = scene_.shapes[shape_index];
        const Material& material = scene_.materials[shape.material];
        std::visit(
            [&]<typename Kind>(const Kind& kind) {
                if constexpr (std::is_same_v<Kind, TriangleMesh>)
                    add_triangle(kind, primitive, material);
                else
                    add_analytic(kind, material);
            },
            shape.geometry);
    }

    bool is_whole() const {
        return is_flat_ && !holds_others_ && std::abs(area_ / (pi * radius_ * radius_) - 1.0) < whole_tolerance;
    }

    std::optional<FlatSurroundings> flat() && {
        if (!is_flat_ || is_analytic_ || point_.normal.dot(point_.geometric_normal) < 1.0f - 1e-6f) return std::nullopt;
        return std::move(flat_);
    }

private:
    using Corners = std::array<VectorD, 3>;  // from the point

    void add_triangle(const TriangleMesh& mesh, std::uint32_t primitive, const Material& material) {
        const auto& triangle = mesh.triangles[primitive];
        const Vector& normal = mesh.geometric_normals[primitive];
        if (normal == Vector(0.0f)) return;  // without area
        const Corners corners{from_point(mesh.positions[triangle.x]), from_point(mesh.positions[triangle.y]),
                              from_point(mesh.positions[triangle.z])};
        const double area = area_in_ball(corners, normal);
        if (!(area > 1e-12 * radius_ * radius_)) return;
        const Acceptance acceptance = acceptance_on(mesh, triangle, normal, material);
        const bool coplanar = is_coplanar(corners);
        if (acceptance == Acceptance::Unknown || (acceptance == Acceptance::Everywhere && !coplanar)) {
            is_flat_ = false;
        } else if (acceptance == Acceptance::Everywhere) {
            area_ += area;
            std::array<Imath::V2d, 3> flat{in_plane(corners[0]), in_plane(corners[1]), in_plane(corners[2])};
            if ((flat[1] - flat[0]).cross(flat[2] - flat[0]) < 0.0) std::swap(flat[1], flat[2]);
            flat_.triangles.push_back(flat);
        } else {
            holds_others_ = true;
            if (!coplanar) add_wall(corners);
        }
    }

    template <typename Kind>
    void add_analytic(const Kind& kind, const Material& material) {
        if constexpr (KnowsItsWhole<Kind>)
            if (kind.distance_to(point_.position) > radius_) return;
        is_flat_ = false;
        if constexpr (KnowsItsWhole<Kind>) {
            const std::optional<Vector> normal = kind.whole_within(point_.position, radius_);
            if (!normal || !takes_photons_everywhere(*normal, material) || !is_on_side(*normal, material)) return;
            is_flat_ = is_analytic_ = true;
            area_ += pi * radius_ * radius_;
        }
    }

    /// It scatters light on the point's side, whatever the place.
    bool takes_photons_everywhere(const Vector& normal, const Material& material) const {
        if (may_be_black_by_texture(material) || has_turned_normals(material)) return false;
        const Bsdf bsdf = bsdf_at(material, Imath::V2f(0.0f), normal.dot(point_.normal) < 0.0f);
        return is_scattering(bsdf) && !is_black(bsdf);
    }
    bool is_on_side(const Vector& normal, const Material& material) const {
        return normal.dot(point_.normal) > 0.0f || is_seen_from_behind(material);
    }

    Acceptance acceptance_on(const TriangleMesh& mesh, const Imath::Vec3<std::uint32_t>& triangle, const Vector& normal,
                             const Material& material) const {
        if (!is_on_side(normal, material) || !may_scatter(material)) return Acceptance::Nowhere;
        float least = std::abs(normal.dot(point_.normal));
        float most = least;
        if (!mesh.normals.empty())
            for (const std::uint32_t corner : {triangle.x, triangle.y, triangle.z}) {
                const float cosine = std::abs(mesh.normals[corner].dot(point_.normal));
                least = std::min(least, cosine);
                most = std::max(most, cosine);
            }
        if (most < surely_disagree && mesh.normals.empty()) return Acceptance::Nowhere;
        return least > surely_agree && takes_photons_everywhere(normal, material) ? Acceptance::Everywhere
                                                                                  : Acceptance::Unknown;
    }

    VectorD from_point(const Vector& position) const { return VectorD(position) - VectorD(point_.position); }
    Imath::V2d in_plane(const VectorD& offset) const {
        return {offset.dot(VectorD(frame_.tangent)), offset.dot(VectorD(frame_.bitangent))};
    }
    double height(const VectorD& offset) const { return offset.dot(VectorD(frame_.normal)); }

    double area_in_ball(const Corners& corners, const Vector& normal) const {
        const double distance = corners[0].dot(VectorD(normal));
        const double squared_radius = radius_ * radius_ - distance * distance;
        if (squared_radius <= 0.0) return 0.0;
        const Frame frame = make_frame(normal);
        const auto on_it = [&](const VectorD& p) {
            return Imath::V2d(p.dot(VectorD(frame.tangent)), p.dot(VectorD(frame.bitangent)));
        };
        return area_in_circle(on_it(corners[0]), on_it(corners[1]), on_it(corners[2]), std::sqrt(squared_radius));
    }

    /// Corners far away may be off the plane by more.
    bool is_coplanar(const Corners& corners) const {
        return std::all_of(corners.begin(), corners.end(), [&](const VectorD& corner) {
            return std::abs(height(corner)) <= flatness * std::max(1.0, corner.length());
        });
    }

    /// Where the triangle passes the height of lifted points.
    void add_wall(const Corners& corners) {
        std::array<Imath::V2d, 2> ends;
        int found = 0;
        for (std::size_t i = 0; i < 3 && found < 2; ++i) {
            const VectorD& a = corners[i];
            const VectorD& b = corners[(i + 1) % 3];
            const double from = height(a) - lifted;
            const double to = height(b) - lifted;
            if ((from > 0.0) == (to > 0.0)) continue;
            ends[static_cast<std::size_t>(found++)] = in_plane(a + (b - a) * (from / (from - to)));
        }
        if (found == 2) flat_.walls.push_back(ends);
    }

    const Scene& scene_;
    const SurfaceEnd& point_;
    const Frame frame_;
    const double radius_;
    double area_ = 0.0;  // on which photons are accepted
    bool is_flat_ = true;
    bool is_analytic_ = false;
    bool holds_others_ = false;
    FlatSurroundings flat_;
};

bool take_primitive(RTCPointQueryFunctionArguments* arguments) {
    static_cast<BallContent*>(arguments->userPtr)->add(arguments->geomID, arguments->primID);
    return false;  // the ball stays as it is
}

BallContent content_of_ball(const Scene& scene, const SurfaceEnd& point, double radius) {
    BallContent content(scene, point, radius);
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    RTCPointQuery query{};
    query.x = point.position.x;
    query.y = point.position.y;
    query.z = point.position.z;
    query.radius = static_cast<float>(radius) + std::numeric_limits<float>::epsilon();
    rtcPointQuery(scene.embree->scene, &query, &context, take_primitive, &content);
    return content;
}

}  // namespace

bool is_whole_around(const Scene& scene, const SurfaceEnd& point, double radius) {
    return content_of_ball(scene, point, radius).is_whole();
}

std::optional<FlatSurroundings> flat_surroundings(const Scene& scene, const SurfaceEnd& point, double radius) {
    return content_of_ball(scene, point, radius).flat();
}

void find_crossings(const Scene& scene, const Ray& ray, float length, std::vector<Hit>& hits) {
    constexpr std::size_t most = 64;  // of hair, nothing more can be said
    hits.clear();
    float beyond = 0.0f;
    while (hits.size() < most) {
        const std::optional<Hit> hit = intersect_between(scene, ray, beyond, length);
        if (!hit) return;
        hits.push_back(*hit);
        beyond = hit->distance + std::numeric_limits<float>::epsilon();
    }
}

}  // namespace photonlab
