// The scene as the estimators see it: const after building, moved and scaled to a unit box around the origin, with
// Embree inside. All lengths and positions here are in units of that box unless a name says "scene units".
//
// Radiance does not depend on the unit of length, so area lights keep theirs; a point light's intensity is divided
// by the square of the unit. Power here is power in scene units divided by unit_length^2.

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/math.h"
#include "scene/description.h"

namespace photonlab {

/// Pinhole or thin lens. The ray through (x, y) in pixels, y down, leaves `position` in direction
/// forward + right * (x/width - 1/2) + down * (y/height - 1/2), to be normalised; with a lens it leaves a point of it,
/// and meets that ray in the plane at `focus_distance`.
struct Camera {
    Vector position;
    VectorD forward;  ///< to the middle of the image plane at distance 1: unit length, but where a film is cropped
    VectorD right;    ///< as long as the image plane at distance 1 is wide
    VectorD down;     ///< as long as the image plane at distance 1 is high
    int width;
    int height;
    double pixel_angle;  ///< angle that a central pixel is wide, radians; of small angles: its width at distance 1
    double aperture_radius = 0.0;  ///< of the lens, unit box; 0: a pinhole
    double focus_distance = 1.0;   ///< along `forward`, unit box

    bool has_lens() const { return aperture_radius > 0.0; }

    /// Its direction is unit. `on_lens` in [0, 1)^2 is uniform over the lens; a pinhole does not look at it.
    Ray ray(double x, double y, const Imath::V2f& on_lens) const;
};

struct EmbreeScene;  // owns the device and the scene of Embree
struct EmbreeSceneDeleter {
    void operator()(EmbreeScene* embree) const;
};

struct Scene {
    std::string name;
    std::string hash;  ///< of the scene file and all it reads, hexadecimal
    std::vector<std::string> notes;
    double unit_length = 1.0;  ///< scene units in one unit of the box
    VectorD centre;            ///< of the box, in scene units
    std::vector<Material> materials;
    std::vector<Shape> shapes;
    std::vector<Emitter> emitters;             ///< only those with power above 0
    std::optional<std::uint32_t> environment;  ///< that of them which is around the scene
    double total_power = 0.0;                  ///< sum of mean_channel(power) over emitters
    Camera camera;
    int max_depth = -1;
    float bounding_radius = 0.0f;  ///< of the bounding box of what the unit box is made for: half its diagonal; 0
                                   ///< without surfaces
    std::unique_ptr<EmbreeScene, EmbreeSceneDeleter> embree;
};

/// True when light goes on in single directions from some surface, as by mirrors and glass: without, no photon is
/// caustic and no camera path branches.
bool has_specular_surfaces(const Scene& scene);

/// Resolution to render at, in place of the scene file's; the horizontal field of view is kept.
struct Resolution {
    int width;
    int height;
};

/// Moves, scales and indexes, and forgets each shape's description as soon as it is placed. Throws InputError for what
/// cannot be rendered: non-finite vertices, reflectance outside [0, 1], a radius or field of view out of range, a
/// resolution below 1 x 1.
Scene build_scene(SceneDescription description, std::optional<Resolution> resolution = std::nullopt);

/// First surface along the ray, or nothing.
std::optional<Hit> intersect(const Scene& scene, const Ray& ray);

/// The same between two distances from its origin.
std::optional<Hit> intersect_between(const Scene& scene, const Ray& ray, float nearest, float farthest);

/// Two points, which the caller has moved off their own surfaces (offset_from_surface).
struct Segment {
    Vector from;
    Vector to;
};

/// True when a surface lies strictly between the two points.
bool is_occluded(const Scene& scene, const Segment& segment);

/// is_occluded() of up to eight segments at once: a bit each, the first one's lowest. Three times as fast when they are
/// neighbours.
unsigned occluded_of_eight(const Scene& scene, std::span<const Segment> segments);

/// A surface point turned to the side that a direction came from, ready to be shaded.
struct Surface {
    Bsdf bsdf;               ///< as seen from `outgoing`'s side, textures looked up
    std::uint32_t material;  ///< index into Scene::materials
    Imath::V2f texture_coordinate;
    Frame frame;              ///< around the shading normal, which faces `outgoing`
    Vector geometric_normal;  ///< unit, facing `outgoing` too
    Vector position;
    bool from_back;  ///< `outgoing` is on the shape's inside
};

/// The shading normal at a hit, as the material's texture turns it: unit, on the side of the geometric normal where it
/// is not mirrored.
Vector turned_normal(const Shape& shape, const Hit& hit, const NormalTexture& normals);

/// The frame around a unit `normal`, of the side that is seen, in which an anisotropic material is at home: its tangent
/// is along the surface's u, on a bumped surface along that surface's.
Frame frame_along_u(const Scene& scene, const Hit& hit, const Vector& normal, bool from_back);

/// What orient() gives where shading and geometric normal disagree about the side of `outgoing`: light goes straight on
/// there as through a hole, where the material has any, and else nowhere.
std::optional<Surface> passed_straight(const Scene& scene, const Hit& hit, const Vector& outgoing);

/// orient() with that shading normal. Both are part of each step of a path: a call is a twentieth of the instructions
/// that a step takes beside its ray.
[[gnu::always_inline]] inline std::optional<Surface> orient_by(const Scene& scene, const Hit& hit,
                                                               const Vector& outgoing, const Vector& shading_normal) {
    const std::uint32_t material_index = scene.shapes[hit.shape].material;
    const Material& material = scene.materials[material_index];
    const float geometric = hit.geometric_normal.dot(outgoing);
    const bool from_back = geometric < 0.0f;
    const float shading = shading_normal.dot(outgoing);
    if (!(geometric * shading > 0.0f)) return passed_straight(scene, hit, outgoing);
    if (from_back && !material.two_sided && !is_seen_from_behind(material)) return std::nullopt;
    std::optional<Surface> surface(std::in_place);
    put_bsdf_at(surface->bsdf, material, hit.texture_coordinate, from_back);
    if (is_black(surface->bsdf)) return std::nullopt;
    const float side = from_back ? -1.0f : 1.0f;
    surface->material = material_index;
    surface->texture_coordinate = hit.texture_coordinate;
    const Vector normal = shading_normal * side;
    surface->frame = material.is_anisotropic ? frame_along_u(scene, hit, normal, from_back) : make_frame(normal);
    surface->geometric_normal = hit.geometric_normal * side;
    surface->position = hit.position;
    surface->from_back = from_back;
    return surface;
}

/// Turns the hit to the side of `outgoing` (unit, away from the surface). Empty when nothing can be reflected there:
/// the back of a one-sided opaque material, a black material, or a direction on whose side shading and geometric normal
/// disagree, unless the material has holes.
[[gnu::always_inline]] inline std::optional<Surface> orient(const Scene& scene, const Hit& hit,
                                                            const Vector& outgoing) {
    const Material& material = scene.materials[scene.shapes[hit.shape].material];
    const bool from_back = hit.geometric_normal.dot(outgoing) < 0.0f;
    const std::optional<NormalTexture>& normals = from_back ? material.normals_behind : material.normals;
    return orient_by(scene, hit, outgoing,
                     normals ? turned_normal(scene.shapes[hit.shape], hit, *normals) : hit.shading_normal);
}

/// The normal by which photons are kept and accepted, and by whose cosine their power is kept: the shading normal, but
/// the geometric one where a texture turns normals. These may change within any gather radius, and what a photon brings
/// is up to that of the point that gathers.
inline const Vector& gather_normal(const Material& material, const Vector& shading, const Vector& geometric) {
    return has_turned_normals(material) ? geometric : shading;
}

/// orient() as photons are kept: with gather_normal().
std::optional<Surface> orient_to_gather(const Scene& scene, const Hit& hit, const Vector& outgoing);

/// True when both normals see `direction` on the same side; a path must not continue in any other direction.
inline bool sides_agree(const Surface& surface, const Vector& direction) {
    return surface.frame.normal.dot(direction) * surface.geometric_normal.dot(direction) > 0.0f;
}

}  // namespace photonlab
