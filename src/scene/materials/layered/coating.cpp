#include "scene/materials/layered/coating.h"

#include <fmt/format.h>

#include "core/sampling.h"
#include "scene/materials/material_reader.h"
#include "scene/materials/smooth/dielectric.h"

namespace photonlab {

/// A direction outside, inside the coat.
struct Coating::Refracted {
    Vector direction;  // on the same side of the surface
    double reflected;  // Fresnel's share on the way
};

Coating::Refracted Coating::refracted(const Vector& direction) const {
    if (index_outside == index_inside) return {direction, 0.0};
    const FresnelDielectric fresnel = fresnel_dielectric(direction.z, eta());
    const VectorD inside(eta() * direction.x, eta() * direction.y, fresnel.cos_beyond);
    return {Vector(inside.normalized()), fresnel.reflected};
}

/// Where a direction inside the coat leaves it; empty at total reflection.
std::optional<Vector> Coating::let_out(const Vector& inside) const {
    const VectorD along(inside.x / eta(), inside.y / eta(), 0.0);
    const double squared_cosine = 1.0 - along.length2();
    if (!(squared_cosine > 0.0)) return std::nullopt;
    return Vector(VectorD(along.x, along.y, std::sqrt(squared_cosine)).normalized());
}

Color Coating::let_through(const Refracted& outgoing, const Refracted& incoming) const {
    Color result((static_cast<float>((1.0 - outgoing.reflected) * (1.0 - incoming.reflected))));
    if (photonlab::is_black(absorption)) return result;
    const float way = 1.0f / outgoing.direction.z + 1.0f / incoming.direction.z;
    for (int channel = 0; channel < 3; ++channel) result[channel] *= std::exp(-absorption[channel] * way);
    return result;
}

float Coating::coat_share(const Refracted& outgoing) const {
    const auto coat = static_cast<float>(outgoing.reflected) * max_channel(specular_reflectance);
    const auto below = static_cast<float>(1.0 - outgoing.reflected);
    return share_beside(coat, below);
}

SpecularBranches Coating::branches(const Vector& outgoing, Carried carried) const {
    SpecularBranches result;
    if (outgoing.z <= 0.0f) return result;
    const Refracted way_in = refracted(outgoing);
    if (way_in.reflected > 0.0)
        result.add(mirror_direction(outgoing), specular_reflectance * static_cast<float>(way_in.reflected));
    if (way_in.reflected >= 1.0) return result;
    for (const SpecularBranch& branch : inner.branches(way_in.direction, carried))
        if (const auto outside = let_out(branch.incoming))
            result.add(*outside, branch.weight * let_through(way_in, refracted(*outside)));
    return result;
}

Color Coating::evaluate(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return Color(0.0f);
    const Refracted way_in = refracted(outgoing);
    const Refracted way_out = refracted(incoming);
    if (way_in.reflected >= 1.0 || way_out.reflected >= 1.0) return Color(0.0f);
    return inner.evaluate(way_in.direction, way_out.direction) * let_through(way_in, way_out) *
           static_cast<float>(eta() * eta());
}

std::optional<BsdfSample> Coating::sample(const Vector& outgoing, Carried carried, const Imath::V2f& u) const {
    if (outgoing.z <= 0.0f) return std::nullopt;
    const Refracted way_in = refracted(outgoing);
    const float share = coat_share(way_in);
    const ShareChoice coat = choose_by_share(u.x, share);
    if (coat.is_chosen)
        return BsdfSample{mirror_direction(outgoing),
                          specular_reflectance * (static_cast<float>(way_in.reflected) / share), 0.0f};
    if (way_in.reflected >= 1.0) return std::nullopt;
    const auto below = inner.sample(way_in.direction, carried, {coat.rest, u.y});
    const auto outside = below ? let_out(below->incoming) : std::nullopt;
    if (!outside) return std::nullopt;
    const Color weight = below->weight * let_through(way_in, refracted(*outside)) / (1.0f - share);
    return BsdfSample{*outside, weight, below->density > 0.0f ? density(outgoing, *outside) : 0.0f};
}

/// Directions are spread by n^2 cos' / cos on the way out.
float Coating::density(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return 0.0f;
    const Refracted way_in = refracted(outgoing);
    const Refracted way_out = refracted(incoming);
    if (way_in.reflected >= 1.0 || way_out.reflected >= 1.0) return 0.0f;
    const double spread = eta() * eta() * incoming.z / way_out.direction.z;
    return (1.0f - coat_share(way_in)) * inner.density(way_in.direction, way_out.direction) *
           static_cast<float>(spread);
}

Coating Coating::at(const Imath::V2f& uv, bool from_back) const {
    Coating result = *this;
    result.inner = inner.at(uv, from_back);
    return result;
}

Coating Coating::read(MaterialReader& reader) {
    Coating coating;
    coating.index_outside = reader.index("ext_ior", "air");
    coating.index_inside = reader.index("int_ior", "bk7");
    coating.specular_reflectance =
        reader.factor_or_texture("specular_reflectance", 1.0, &Coating::specular_reflectance);
    const double thickness = reader.properties.number("thickness").value_or(1.0);
    if (reader.has("sigma_a") && !reader.properties.has("sigma_a")) {
        const auto put = [thickness](Bsdf& bsdf, const Color& sigma) {
            for (int channel = 0; channel < 3; ++channel)
                std::get<Coating>(bsdf).absorption[channel] =
                    static_cast<float>(std::max(0.0, sigma[channel] * thickness));
        };
        reader.material.textures.push_back({reader.color_or_texture("sigma_a", 0.0).texture, put});
    } else {
        // A spectrum of this kind is brought to RGB as an index is, without the white of a light or of a surface.
        const ColorD sigma = reader.properties.index_of_refraction("sigma_a").value_or(ColorD(0.0));
        coating.absorption = Color(sigma * thickness);
    }
    coating.inner.material = &reader.parts(1).front();
    return coating;
}

void Coating::check(const MaterialCheck& check) const {
    check.in_unit_range("specular_reflectance", specular_reflectance);
    check.index(index_outside);
    check.index(index_inside);
    check.require(is_finite(absorption) && std::min({absorption.x, absorption.y, absorption.z}) >= 0.0f,
                  "an absorption of at least 0");
    check.part(inner.material);
    check.require(!inner.transmits(), "a material below through which no light passes");
}

}  // namespace photonlab
