#include "scene/mitsuba/transform.h"

#include <fmt/format.h>

#include "core/error.h"

namespace photonlab {

namespace {

bool is_look_at(const XmlElement& element) {
    return element.tag == "lookat" || element.tag == "lookAt" || element.tag == "look_at";
}

VectorD parse_three(const std::string& text, const std::string& place) {
    const std::vector<double> numbers = parse_numbers(text, place);
    if (numbers.size() != 3) throw InputError(place, fmt::format("expected 3 numbers, got \"{}\"", excerpt(text)));
    return {numbers[0], numbers[1], numbers[2]};
}

/// From rows of column vectors, as Mitsuba writes them, to Imath's transposed form.
Matrix parse_matrix(const XmlElement& element) {
    const std::vector<double> n = parse_numbers(element.require("value"), element.place);
    if (n.size() != 16 && n.size() != 9)
        throw InputError(element.place, fmt::format("expected 16 or 9 numbers in <matrix>, got {}", n.size()));
    const int size = n.size() == 16 ? 4 : 3;
    Matrix result;
    for (int row = 0; row < size; ++row)
        for (int column = 0; column < size; ++column)
            result[column][row] = n[static_cast<std::size_t>(row * size + column)];
    if (result[0][3] != 0.0 || result[1][3] != 0.0 || result[2][3] != 0.0 || result[3][3] != 1.0)
        throw InputError(element.place, "expected an affine matrix: the last row must be 0 0 0 1");
    return result;
}

/// An up for the unit view direction `forward`, where the file has none: what Mitsuba's coordinate_system() gives it.
VectorD up_for(const VectorD& forward, MitsubaFamily family) {
    if (family == MitsubaFamily::Version06) {
        const VectorD side = std::abs(forward.x) > std::abs(forward.y) ? VectorD(forward.z, 0.0, -forward.x)
                                                                       : VectorD(0.0, forward.z, -forward.y);
        return side.normalized().cross(forward);
    }
    const double sign =
        std::copysign(1.0, forward.z);  // [Duff et al. 2017, "Building an Orthonormal Basis, Revisited"]
    const double a = -1.0 / (sign + forward.z);
    return {1.0 + sign * forward.x * forward.x * a, sign * forward.x * forward.y * a, -sign * forward.x};
}

/// Camera axes as Mitsuba's: x to the left of the image, y up, z forward.
Matrix parse_look_at(const XmlElement& element) {
    const VectorD origin = parse_three(element.require("origin"), element.place);
    const VectorD target = parse_three(element.require("target"), element.place);
    const VectorD forward = (target - origin).normalized();
    const VectorD up =
        lacks_up(element) ? up_for(forward, element.family()) : parse_three(element.require("up"), element.place);
    const VectorD left = up.cross(forward).normalized();
    if (forward.length2() == 0.0 || left.length2() == 0.0)
        throw InputError(element.place,
                         "lookat: expected a target away from the origin, and an up that is not the view direction");
    const VectorD new_up = forward.cross(left);
    Matrix result;
    for (int axis = 0; axis < 3; ++axis) {
        result[0][axis] = left[axis];
        result[1][axis] = new_up[axis];
        result[2][axis] = forward[axis];
        result[3][axis] = origin[axis];
    }
    return result;
}

Matrix parse_rotation(const XmlElement& element) {
    const VectorD axis = parse_vector(element).normalized();
    if (axis.length2() == 0.0) throw InputError(element.place, "rotate: expected an axis that is not 0 0 0");
    const double angle = parse_number(element.require("angle"), element.place) * pi / 180.0;
    Matrix result;
    result.setAxisAngle(axis, angle);
    return result;
}

Matrix parse_element(const XmlElement& element) {
    if (element.tag == "matrix") return parse_matrix(element);
    if (is_look_at(element)) return parse_look_at(element);
    if (element.tag == "rotate") return parse_rotation(element);
    Matrix result;
    if (element.tag == "translate") {
        result.setTranslation(parse_vector(element));
    } else if (element.tag == "scale") {
        result.setScale(parse_vector(element, 1.0));
    } else {
        throw InputError(
            element.place,
            fmt::format("unknown transform <{}>; known here: lookat, matrix, rotate, scale, translate", element.tag));
    }
    return result;
}

}  // namespace

VectorD parse_vector(const XmlElement& element, double missing) {
    const char* const axes[] = {"x", "y", "z"};
    if (element.attributes.count("value")) {
        for (const char* axis : axes)
            if (element.attributes.count(axis))
                throw InputError(element.place, fmt::format("<{}>: expected value or x, y, z, got both", element.tag));
        const std::string& text = element.require("value");
        const std::vector<double> numbers = parse_numbers(text, element.place);
        if (numbers.size() == 1) return VectorD(numbers[0]);
        if (numbers.size() != 3)
            throw InputError(element.place, fmt::format("expected 1 or 3 numbers, got \"{}\"", excerpt(text)));
        return {numbers[0], numbers[1], numbers[2]};
    }
    VectorD result(missing);
    bool any = false;
    for (int axis = 0; axis < 3; ++axis) {
        const std::string text = element.attribute(axes[axis]);
        if (text.empty()) continue;
        result[axis] = parse_number(text, element.place);
        any = true;
    }
    if (!any)
        throw InputError(element.place, fmt::format("<{}> needs x, y, z or a value of 1 or 3 numbers", element.tag));
    return result;
}

Matrix parse_transform(const XmlElement& element) {
    Matrix result;
    for (const XmlElement& child : element.children) result = result * parse_element(child);
    const bool is_finite_translation = is_finite(VectorD(result[3][0], result[3][1], result[3][2]));
    if (!(std::abs(handedness(result)) > 0.0) || !std::isfinite(handedness(result)) || !is_finite_translation)
        throw InputError(element.place, "expected an invertible transform with finite values");
    return result;
}

bool lacks_up(const XmlElement& element) {
    if (!is_look_at(element)) return false;
    const std::string up = element.attribute("up");
    return up.find_first_not_of(" ,\t\r\n") == std::string::npos || parse_three(up, element.place) == VectorD(0.0);
}

VectorD transform_point(const Matrix& matrix, const VectorD& point) {
    return point * matrix;
}

VectorD transform_direction(const Matrix& matrix, const VectorD& direction) {
    VectorD result;
    matrix.multDirMatrix(direction, result);
    return result;
}

Matrix matrix_of_normals(const Matrix& matrix) {
    return matrix.inverse().transposed();
}

VectorD transform_normal(const Matrix& matrix, const VectorD& normal) {
    return transform_direction(matrix_of_normals(matrix), normal).normalized();
}

double handedness(const Matrix& m) {
    const VectorD x(m[0][0], m[0][1], m[0][2]);
    const VectorD y(m[1][0], m[1][1], m[1][2]);
    const VectorD z(m[2][0], m[2][1], m[2][2]);
    return x.cross(y).dot(z);
}

double uniform_scale(const Matrix& m, int axis_count, const std::string& place) {
    const VectorD axes[] = {{m[0][0], m[0][1], m[0][2]}, {m[1][0], m[1][1], m[1][2]}, {m[2][0], m[2][1], m[2][2]}};
    const double scale = axes[0].length();
    for (int i = 0; i < axis_count; ++i) {
        const bool same_length = std::abs(axes[i].length() - scale) <= 1e-6 * scale;
        bool perpendicular = true;
        for (int j = 0; j < i; ++j)
            perpendicular = perpendicular && std::abs(axes[i].dot(axes[j])) <= 1e-6 * scale * scale;
        if (!same_length || !perpendicular)
            throw InputError(place, "expected a to_world that scales all directions alike: this shape must stay round");
    }
    return scale;
}

}  // namespace photonlab
