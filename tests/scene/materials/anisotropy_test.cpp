// Where u runs on a surface whose roughness depends on the direction: along the texture coordinates of every kind of
// shape, from both sides, and on what a bump map or a normal map turns; and what scene files say of it.

#include "core/error.h"
#include "image/png.h"
#include "scene/scene.h"
#include "tests/scene/scene_folder.h"

namespace photonlab {
namespace {

const std::string brushed =
    "<bsdf type='roughconductor'><float name='alpha_u' value='0.3'/><float name='alpha_v' value='0.1'/></bsdf>";
const std::string old_brushed =
    "<bsdf type='roughconductor'><float name='alphaU' value='0.3'/><float name='alphaV' value='0.1'/></bsdf>";

std::string placed(const std::string& steps) {
    return "<transform name='to_world'>" + steps + "</transform>";
}

class AnisotropyInScenes : public SceneFolderTest {
protected:
    Scene scene_of(const std::string& type, const std::string& inside, const std::string& version = "3.0.0") const {
        return build_scene(load_as(version, "<shape type='" + type + "'>" + inside + "</shape>"));
    }

    /// The frame at `point`, seen from twice as far from the origin.
    static Frame frame_at(const Scene& scene, const VectorD& point, const VectorD& seen_from) {
        const Vector from((seen_from - scene.centre) / scene.unit_length);
        const Vector direction((point - seen_from).normalized());
        const std::optional<Hit> hit = intersect(scene, {from, direction});
        if (!hit) throw std::runtime_error("the ray meets nothing");
        const std::optional<Surface> surface = orient(scene, *hit, -direction);
        if (!surface) throw std::runtime_error("nothing is reflected there");
        return surface->frame;
    }

    static void expect_along(const Frame& frame, const VectorD& tangent) {
        // Facets are the same both ways along an axis.
        EXPECT_NEAR(std::abs(VectorD(frame.tangent).dot(tangent.normalized())), 1.0, 2e-5);
        EXPECT_NEAR(frame.tangent.dot(frame.normal), 0.0, 1e-6);
        EXPECT_NEAR((frame.normal.cross(frame.tangent) - frame.bitangent).length(), 0.0, 1e-6);
    }

    void write_picture(const std::string& name, const std::vector<ColorD>& pixels, int width) const {
        write_png(folder_ / name, width, static_cast<int>(pixels.size()) / width, pixels);
    }
};

TEST_F(AnisotropyInScenes, RunsAlongUOfEveryShape) {
    const Scene flat = scene_of("rectangle", placed("<rotate z='1' angle='30'/><scale x='2' y='3'/>") + brushed);
    const double angle = pi / 6.0;
    expect_along(frame_at(flat, {0.1, 0.2, 0.0}, {0.1, 0.2, 2.0}), {2.0 * std::cos(angle), 3.0 * std::sin(angle), 0.0});
    for (const VectorD& point : {VectorD(0.6, 0.0, 0.8), VectorD(0.36, 0.48, 0.8), VectorD(0.8, -0.6, 0.0)})
        expect_along(frame_at(scene_of("sphere", brushed), point, point * 2.0), {-point.y, point.x, 0.0});
    expect_along(frame_at(scene_of("disk", brushed), {0.3, 0.4, 0.0}, {0.3, 0.4, 1.0}), {0.3, 0.4, 0.0});
    expect_along(frame_at(scene_of("cylinder", brushed), {0.6, 0.8, 0.4}, {1.2, 1.6, 0.4}), {-0.8, 0.6, 0.0});
    const std::string turned = placed("<rotate x='1' angle='90'/>");  // (x, y, z) to (x, -z, y)
    expect_along(frame_at(scene_of("sphere", turned + brushed), {0.36, -0.8, 0.48}, {0.72, -1.6, 0.96}),
                 {-0.48, 0.0, 0.36});
}

TEST_F(AnisotropyInScenes, IsSeenFromBehindAsFromTheFront) {
    const Scene scene =
        scene_of("rectangle", placed("<rotate z='1' angle='30'/>") + "<bsdf type='twosided'>" + brushed + "</bsdf>");
    const VectorD along(std::cos(pi / 6.0), std::sin(pi / 6.0), 0.0);
    expect_along(frame_at(scene, {0.1, 0.2, 0.0}, {0.1, 0.2, 2.0}), along);
    expect_along(frame_at(scene, {0.1, 0.2, 0.0}, {0.1, 0.2, -2.0}), along);
}

// Without such a material a frame is the one that the normal alone makes.
TEST_F(AnisotropyInScenes, LeavesFramesOfOtherMaterialsAlone) {
    for (const std::string alphas : {"<float name='alpha' value='0.3'/>",
                                     "<float name='alpha_u' value='0.3'/><float name='alpha_v' value='0.3'/>"}) {
        const Scene scene = scene_of("sphere", "<bsdf type='roughconductor'>" + alphas + "</bsdf>");
        const VectorD point(0.36, 0.48, 0.8);
        const Frame frame = frame_at(scene, point, point * 2.0);
        EXPECT_EQ(frame.tangent, make_frame(frame.normal).tangent);
    }
}

// Heights that rise along u and v: u of the bumped surface lies above that of the flat one.
TEST_F(AnisotropyInScenes, TurnsWithABumpMap) {
    write_picture("ramp.png", {ColorD(0.05), ColorD(0.25), ColorD(0.35), ColorD(0.55)}, 2);
    const Scene scene = scene_of("rectangle",
                                 "<bsdf type='bumpmap'><texture type='bitmap'><string name='filename' "
                                 "value='ramp.png'/><boolean name='raw' value='true'/></texture>" +
                                     brushed + "</bsdf>");
    const Frame frame = frame_at(scene, {0.0, 0.0, 0.0}, {0.0, 0.0, 2.0});
    const double slope = -static_cast<double>(frame.normal.x) / static_cast<double>(frame.normal.z);
    ASSERT_GT(std::abs(slope), 0.1);
    ASSERT_GT(std::abs(frame.normal.y), 0.1f);
    expect_along(frame, {1.0, 0.0, slope});
}

TEST_F(AnisotropyInScenes, TurnsWithANormalMap) {
    write_picture("normal.png", {ColorD(0.7, 0.4, 0.9)}, 1);
    for (const std::string version : {"0.6.0", "3.0.0"}) {
        const bool is_old = version == "0.6.0";
        const Scene scene = scene_of(
            "rectangle",
            "<bsdf type='normalmap'><texture type='bitmap' name='normalmap'><string name='filename' "
            "value='normal.png'/>" +
                std::string(is_old ? "<float name='gamma' value='1'/>" : "<boolean name='raw' value='true'/>") +
                "</texture>" + (is_old ? old_brushed : brushed) + "</bsdf>",
            version);
        const Frame frame = frame_at(scene, {0.0, 0.2, 0.0}, {0.0, 0.2, 2.0});
        const VectorD normal(frame.normal);
        ASSERT_GT(std::abs(normal.x), 0.1);
        ASSERT_GT(std::abs(normal.y), 0.1);
        expect_along(frame, VectorD(1, 0, 0) - normal * normal.x);
    }
}

TEST_F(AnisotropyInScenes, OfATextureIsThatOfBothTextures) {
    write_picture("two.png", {ColorD(0.0), ColorD(1.0)}, 2);
    const auto texture = [](const std::string& name, const std::string& step) {
        return "<texture type='bitmap' name='" + name +
               "'><string name='filename' value='two.png'/><string name='filter_type' value='nearest'/><transform "
               "name='to_uv'><translate x='" +
               step + "'/></transform></texture>";
    };
    const auto scene = load_as("3.0.0", "<shape type='rectangle'><bsdf type='roughconductor'>" +
                                            texture("alpha_u", "0") + texture("alpha_v", "0.5") + "</bsdf></shape>");
    const Material& material = scene.materials.at(scene.shapes.at(0).material);
    EXPECT_TRUE(material.is_anisotropic);
    const auto facets = [&](float u) { return std::get<RoughConductor>(bsdf_at(material, {u, 0.5f}, false)).facets; };
    EXPECT_EQ(facets(0.25f).alpha_u, smallest_roughness);
    EXPECT_EQ(facets(0.25f).alpha_v, 1.0f);
    EXPECT_EQ(facets(0.75f).alpha_u, 1.0f);
    EXPECT_EQ(facets(0.75f).alpha_v, smallest_roughness);
}

// 0.6 refuses a mesh that has no u; 3 takes any direction, which is said.
TEST_F(AnisotropyInScenes, WantsTextureCoordinates) {
    write("plain.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const std::string mesh = "<string name='filename' value='plain.obj'/>";
    EXPECT_THROW(scene_of("obj", mesh + old_brushed, "0.6.0"), InputError);
    const auto scene = load_as("3.0.0", "<shape type='obj'>" + mesh + brushed + "</shape>");
    ASSERT_FALSE(scene.notes.empty());
    EXPECT_NE(scene.notes.back().find("a mesh without texture coordinates has none: as in Mitsuba 3 any is taken"),
              std::string::npos)
        << scene.notes.back();
    const Frame frame = frame_at(build_scene(scene), {0.2, 0.2, 0.0}, {0.2, 0.2, 1.0});
    EXPECT_EQ(frame.tangent, make_frame({0.0f, 0.0f, 1.0f}).tangent);
}

TEST_F(AnisotropyInScenes, IsThatOfTheParts) {
    const auto is_anisotropic = [&](const std::string& bsdf) {
        const auto scene = load_as("3.0.0", "<shape type='rectangle'>" + bsdf + "</shape>");
        return scene.materials.at(scene.shapes.at(0).material).is_anisotropic;
    };
    EXPECT_TRUE(is_anisotropic("<bsdf type='mask'>" + brushed + "</bsdf>"));
    EXPECT_TRUE(is_anisotropic("<bsdf type='blendbsdf'><bsdf type='diffuse'/>" + brushed + "</bsdf>"));
    EXPECT_TRUE(is_anisotropic("<bsdf type='twosided'><bsdf type='diffuse'/>" + brushed + "</bsdf>"));
    EXPECT_FALSE(is_anisotropic("<bsdf type='twosided'><bsdf type='diffuse'/></bsdf>"));
}

}  // namespace
}  // namespace photonlab
