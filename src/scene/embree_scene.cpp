// What Embree is told: the buffers of meshes, which it reads where they are, and callbacks for all other shapes. The
// callbacks compute in double, since a float32 quadratic loses a sphere seen from far away, and round only the distance
// that Embree compares.

#include "scene/embree_scene.h"

#include <fmt/format.h>

#include <cassert>
#include <new>
#include <stdexcept>

#include "core/machine/available_memory.h"

namespace photonlab {

namespace {

/// First root strictly inside the ray's interval, or nothing.
std::optional<float> first_hit(const Analytic& shape, const RTCRay& ray) {
    const VectorD origin(ray.org_x, ray.org_y, ray.org_z);
    const VectorD direction(ray.dir_x, ray.dir_y, ray.dir_z);
    const Roots roots = std::visit([&](const auto& s) { return s.roots(origin, direction); }, shape);
    for (int i = 0; i < roots.count; ++i) {
        const double t = roots.t[i];
        if (t > ray.tnear && t < ray.tfar) return static_cast<float>(t);
    }
    return std::nullopt;
}

const Analytic& shape_of(void* pointer) {
    return *static_cast<Analytic*>(pointer);
}

void set_bounds(const RTCBoundsFunctionArguments* arguments) {
    const auto& shape = shape_of(arguments->geometryUserPtr);
    auto [centre, reach] = std::visit([](const auto& kind) { return kind.extent(); }, shape);
    // A little wider than the shape, so that rounding cannot put a hit outside its bounds.
    const float slack = 4.0f * std::numeric_limits<float>::epsilon();
    reach += (Vector(std::abs(centre.x), std::abs(centre.y), std::abs(centre.z)) + reach + Vector(slack)) * slack;
    RTCBounds& bounds = *arguments->bounds_o;
    bounds.lower_x = centre.x - reach.x;
    bounds.lower_y = centre.y - reach.y;
    bounds.lower_z = centre.z - reach.z;
    bounds.upper_x = centre.x + reach.x;
    bounds.upper_y = centre.y + reach.y;
    bounds.upper_z = centre.z + reach.z;
}

// Nearest hits are only ever asked of single rays, so N is 1 and the packet is a plain struct.
void intersect_callback(const RTCIntersectFunctionNArguments* arguments) {
    if (!arguments->valid[0]) return;
    auto& query = *reinterpret_cast<RTCRayHit*>(arguments->rayhit);
    const std::optional<float> t = first_hit(shape_of(arguments->geometryUserPtr), query.ray);
    if (!t) return;
    query.ray.tfar = *t;
    query.hit.geomID = arguments->geomID;
    query.hit.primID = arguments->primID;
    query.hit.instID[0] = arguments->context->instID[0];
    query.hit.u = query.hit.v = 0.0f;
}

void occluded_callback(const RTCOccludedFunctionNArguments* arguments) {
    for (unsigned i = 0; i < arguments->N; ++i) {
        if (!arguments->valid[i]) continue;
        const RTCRay ray = rtcGetRayFromRayN(arguments->ray, arguments->N, i);
        if (first_hit(shape_of(arguments->geometryUserPtr), ray))
            RTCRayN_tfar(arguments->ray, arguments->N, i) = -infinity;
    }
}

/// Asked after whatever may fail: Embree goes on, and remembers it. An exception thrown from a function of ours that it
/// would call at once leaves it as it is in the middle of things, and it then ends the program when it is released.
void require_success(RTCDevice device) {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_NONE) return;
    if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    throw std::runtime_error(fmt::format("Embree: error {}", static_cast<int>(error)));
}

/// One device for all scenes, since Embree can make no more than about a thousand. One thread builds: then no tie
/// between surfaces that coincide can depend on how many there are. Configuration files would be settings from outside.
/// Tracing runs on the caller's threads. It is never released: that starts a thread, which there may be no room for.
RTCDevice shared_device() {
    static const RTCDevice shared = [] {
        const RTCDevice device = rtcNewDevice("threads=1,start_threads=0,ignore_config_files=1");
        require_success(device);
        return device;
    }();
    return shared;
}

RTCGeometry make_mesh(RTCDevice device, const TriangleMesh& mesh) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    if (mesh.triangles.empty()) return geometry;  // Embree has no empty buffers
    assert(mesh.positions.capacity() > mesh.positions.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.positions.data(), 0,
                               sizeof(Vector), mesh.positions.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                               sizeof(mesh.triangles[0]), mesh.triangles.size());
    require_success(device);
    return geometry;
}

RTCGeometry make_analytic(RTCDevice device, Analytic& shape) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, 1);
    rtcSetGeometryUserData(geometry, &shape);
    rtcSetGeometryBoundsFunction(geometry, set_bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect_callback);
    rtcSetGeometryOccludedFunction(geometry, occluded_callback);
    return geometry;
}

/// What Embree takes at most, as measured of a million triangles: its tree, and what it needs to build it.
std::uint64_t bytes_in_embree(const std::vector<Shape>& shapes) {
    constexpr std::uint64_t bytes_of_triangle = 100;
    std::uint64_t bytes = 0;
    for (const Shape& shape : shapes)
        if (const auto* mesh = std::get_if<TriangleMesh>(&shape.geometry))
            bytes += mesh->triangles.size() * bytes_of_triangle;
    return bytes;
}

}  // namespace

EmbreeScene::~EmbreeScene() {
    if (scene) rtcReleaseScene(scene);
}

void EmbreeSceneDeleter::operator()(EmbreeScene* embree) const {
    delete embree;
}

std::unique_ptr<EmbreeScene, EmbreeSceneDeleter> build_embree_scene(const std::vector<Shape>& shapes,
                                                                    const std::string& name) {
    require_memory_for(name, bytes_in_embree(shapes));
    std::unique_ptr<EmbreeScene, EmbreeSceneDeleter> embree(new EmbreeScene);
    const RTCDevice device = shared_device();
    embree->scene = rtcNewScene(device);
    require_success(device);
    rtcSetSceneFlags(embree->scene, RTC_SCENE_FLAG_ROBUST);

    for (const Shape& shape : shapes) {
        std::visit(
            [&]<typename Kind>(const Kind& kind) {
                if constexpr (AnalyticKind<Kind>) embree->analytic.emplace_back(kind);
            },
            shape.geometry);
    }
    std::size_t next_analytic = 0;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        const auto* mesh = std::get_if<TriangleMesh>(&shapes[i].geometry);
        RTCGeometry geometry =
            mesh ? make_mesh(device, *mesh) : make_analytic(device, embree->analytic[next_analytic++]);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(embree->scene, geometry, static_cast<unsigned>(i));
        rtcReleaseGeometry(geometry);
        require_success(device);
    }
    rtcCommitScene(embree->scene);
    require_success(device);
    return embree;
}

}  // namespace photonlab
