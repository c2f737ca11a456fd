// Mitsuba's <transform>: elements applied in the order in which they stand.

#pragma once

#include "core/math.h"
#include "scene/mitsuba/xml_reader.h"

namespace photonlab {

/// The transform from local to world, in Imath's row-vector convention: p' = p * M. Throws InputError.
Matrix parse_transform(const XmlElement& element);

/// True for a <lookat> that leaves its up open.
bool lacks_up(const XmlElement& element);

/// A vector's or point's three numbers: from `value`, where one number stands for all three, or from x, y, z (each
/// `missing` when it is not there).
VectorD parse_vector(const XmlElement& element, double missing = 0.0);

VectorD transform_point(const Matrix& matrix, const VectorD& point);
VectorD transform_direction(const Matrix& matrix, const VectorD& direction);

/// The inverse transpose, which takes normals, as directions, to where the matrix takes points.
Matrix matrix_of_normals(const Matrix& matrix);

/// A unit normal.
VectorD transform_normal(const Matrix& matrix, const VectorD& normal);

/// Determinant of the 3 x 3 part: negative for a mirroring.
double handedness(const Matrix& matrix);

/// The factor by which the matrix scales lengths along its first axes, 3 for a sphere, 2 for a disk in its plane;
/// InputError at `place` when they are scaled differently or sheared.
double uniform_scale(const Matrix& matrix, int axis_count, const std::string& place);

}  // namespace photonlab
