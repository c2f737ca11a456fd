#include "scene/emitters/infinity/environment_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "scene/emitters/light_reader.h"
#include "scene/textures/image_file.h"

namespace photonlab {

EnvironmentImage::EnvironmentImage(ColorImage image, Rows rows) : image_(std::move(image)) {
    const auto height = static_cast<std::size_t>(image_.height);
    edges_.push_back(0.0);
    if (rows == Rows::Centred || height == 1) {
        for (std::size_t row = 0; row < height; ++row) {
            rows_.emplace_back(row == 0 ? 0 : row - 1, row);
            edges_.push_back((static_cast<double>(row) + 0.5) / static_cast<double>(height));
        }
        rows_.emplace_back(height - 1, height - 1);
        edges_.push_back(1.0);
    } else {
        for (std::size_t row = 0; row + 1 < height; ++row) {
            rows_.emplace_back(row, row + 1);
            edges_.push_back(static_cast<double>(row + 1) / static_cast<double>(height - 1));
        }
    }
    const auto width = static_cast<std::size_t>(image_.width);
    row_cdf_.assign(rows_.size(), 0.0);
    column_cdf_.assign(rows_.size() * width, 0.0);
    double all = 0.0;
    for (std::size_t row = 0; row < rows_.size(); ++row) {
        double in_row = 0.0;
        for (std::size_t column = 0; column < width; ++column) {
            const ColorD mean = mean_of(row, column);
            integral_ += mean * solid_angle(row);
            in_row += mean_channel(mean);
            column_cdf_[row * width + column] = in_row;
        }
        all += in_row * solid_angle(row);
        row_cdf_[row] = all;
        for (std::size_t column = 0; in_row > 0.0 && column < width; ++column)
            column_cdf_[row * width + column] /= in_row;
    }
    for (double& share : row_cdf_) share = all > 0.0 ? share / all : 0.0;
}

ColorD EnvironmentImage::pixel(std::size_t row, std::size_t column) const {
    const auto width = static_cast<std::size_t>(image_.width);
    return ColorD(image_.pixels[row * width + column % width]);
}

ColorD EnvironmentImage::mean_of(std::size_t row, std::size_t column) const {
    const auto [above, below] = rows_[row];
    return (pixel(above, column) + pixel(above, column + 1) + pixel(below, column) + pixel(below, column + 1)) * 0.25;
}

double EnvironmentImage::solid_angle(std::size_t row) const {
    return 2.0 * pi / image_.width * (std::cos(pi * edges_[row]) - std::cos(pi * edges_[row + 1]));
}

EnvironmentImage::Cell EnvironmentImage::cell_at(const VectorD& local) const {
    // The polar angle from its sine where its cosine would lose it.
    const double polar = std::atan2(std::hypot(local.x, local.z), local.y) / pi;
    const auto next = std::upper_bound(edges_.begin() + 1, edges_.end() - 1, polar);
    const auto row = static_cast<std::size_t>(next - edges_.begin()) - 1;
    const double around = turn_to(-local.z, local.x) * image_.width - 0.5;  // from the centre of the first column
    const double left = std::floor(around);
    const auto column = static_cast<std::size_t>(left < 0.0 ? left + image_.width : left);
    return {row, column, std::clamp((polar - edges_[row]) / (edges_[row + 1] - edges_[row]), 0.0, 1.0), around - left};
}

ColorD EnvironmentImage::radiance(const VectorD& local) const {
    const Cell cell = cell_at(local);
    const auto [above, below] = rows_[cell.row];
    const ColorD upper = pixel(above, cell.column) * (1.0 - cell.right) + pixel(above, cell.column + 1) * cell.right;
    const ColorD lower = pixel(below, cell.column) * (1.0 - cell.right) + pixel(below, cell.column + 1) * cell.right;
    return upper * (1.0 - cell.down) + lower * cell.down;
}

double EnvironmentImage::density(const VectorD& local) const {
    const auto width = static_cast<std::size_t>(image_.width);
    const Cell cell = cell_at(local);
    const double of_row = row_cdf_[cell.row] - (cell.row > 0 ? row_cdf_[cell.row - 1] : 0.0);
    const double* cdf = &column_cdf_[cell.row * width];
    const double of_column = cdf[cell.column] - (cell.column > 0 ? cdf[cell.column - 1] : 0.0);
    return of_row * of_column / solid_angle(cell.row);
}

namespace {

/// Index of the step of a running share that u falls into, and where in it; u becomes that.
std::size_t step_of(const double* begin, const double* end, double& u) {
    const double* found = std::min(std::upper_bound(begin, end, u), end - 1);
    const double before = found == begin ? 0.0 : *(found - 1);
    u = *found > before ? std::min((u - before) / (*found - before), 1.0) : 0.5;
    return static_cast<std::size_t>(found - begin);
}

}  // namespace

VectorD EnvironmentImage::sample(const Imath::V2f& u) const {
    const auto width = static_cast<std::size_t>(image_.width);
    double down = u.y;
    double right = u.x;
    const std::size_t row = step_of(row_cdf_.data(), row_cdf_.data() + row_cdf_.size(), down);
    const double* cdf = &column_cdf_[row * width];
    const std::size_t column = step_of(cdf, cdf + width, right);
    // Uniform in the cell's solid angle.
    const double top = std::cos(pi * edges_[row]);
    const double cosine = top + (std::cos(pi * edges_[row + 1]) - top) * down;
    const double sine = std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine)));
    const double angle = 2.0 * pi * (static_cast<double>(column) + 0.5 + right) / static_cast<double>(width);
    return {sine * std::sin(angle), cosine, -sine * std::cos(angle)};
}

// ---------------------------------------------------------------------------------------------------------------------

EnvironmentMapDescription EnvironmentMap::read(LightReader& reader) {
    reader.require_no_objects();
    const std::filesystem::path file = reader.require_file();
    const Decoding decoding = reader.is_version_06() ? read_gamma(reader) : Decoding{};
    const double scale = reader.properties.number("scale").value_or(1.0);
    if (!(scale >= 0.0))
        throw InputError(reader.properties.place_of("scale"),
                         fmt::format("scale: expected a number of at least 0, got {}", scale));
    const TextureAxes axes = reader.axes();
    ColorImage image = read_scene_image(reader, file, decoding, EnvironmentImage::bytes_to_pixel);
    for (const Color& pixel : image.pixels)
        if (!is_finite(pixel) || std::min({pixel.x, pixel.y, pixel.z}) < 0.0f)
            throw InputError(reader.properties.place_of("filename"),
                             fmt::format("{}: expected radiances of at least 0, got {} {} {}", file.string(), pixel.x,
                                         pixel.y, pixel.z));
    const auto rows = reader.is_version_06() ? EnvironmentImage::Rows::Centred : EnvironmentImage::Rows::FromPoleToPole;
    return {.image = std::make_shared<const EnvironmentImage>(std::move(image), rows),
            .scale = scale,
            .axes = axes,
            .place = reader.element.place};
}

void EnvironmentMapDescription::check() const {
    if (!image) throw InputError(place, "envmap: expected an image");
    require_light(image->integral() * scale, place, "radiance");
}

EnvironmentMap EnvironmentMapDescription::placed(const SceneExtent& extent) const {
    return {image, scale, axes, EntryDiscs(extent)};
}

VectorD EnvironmentMap::to_local(const Vector& world) const {
    const VectorD direction(world);
    return VectorD(direction.dot(axes[0]), direction.dot(axes[1]), direction.dot(axes[2])).normalized();
}

Vector EnvironmentMap::to_world(const VectorD& local) const {
    return Vector((axes[0] * local.x + axes[1] * local.y + axes[2] * local.z).normalized());
}

Emission EnvironmentMap::emit(const std::vector<Shape>& shapes, const EmissionDraw& draw) const {
    const Vector towards = to_world(image->sample(draw.u_direction));
    EntryDiscs::Entry entry = discs.draw(-towards, draw.u_position, draw.u_triangle);
    const ColorD all = power(shapes);
    const double density = density_of(towards) * entry.density;
    ColorD flux = density > 0.0 ? radiance_from(towards) / density : ColorD(0.0);
    for (int channel = 0; channel < 3; ++channel)
        flux[channel] = all[channel] > 0.0 ? flux[channel] / all[channel] : 0.0;
    entry.emission.share = flux;
    return entry.emission;
}

std::optional<DirectSample> EnvironmentMap::sample_direct(const std::vector<Shape>&, const Vector& receiver,
                                                          const Imath::V2f& u, double) const {
    const Vector direction = to_world(image->sample(u));
    const double density = density_of(direction);
    if (!(density > 0.0)) return std::nullopt;
    return DirectSample{.position = discs.beyond(receiver, direction),
                        .direction = direction,
                        .radiance = radiance_from(direction),
                        .density = density,
                        .is_delta = false};
}

}  // namespace photonlab
