#include "scene/mitsuba/spectrum.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/error.h"
#include "scene/mitsuba/xml_reader.h"

namespace photonlab {

namespace {

struct ObserverRow {
    double x, y, z;  ///< the observer's colour matching functions
    double d65;      ///< the illuminant's relative power
};

constexpr double first_wavelength = 360.0;  ///< nm
constexpr double last_wavelength = 830.0;
constexpr double table_step = 5.0;

/// CIE 1931 2-degree observer and CIE standard illuminant D65 (CIE 15:2004, tables T.4 and T.1), every 5 nm.
// clang-format off
constexpr std::array<ObserverRow, 95> table{{
    {0.0001299, 0.000003917, 0.0006061, 46.6383}, {0.0002321, 0.000006965, 0.001086, 49.3637},
    {0.0004149, 0.00001239, 0.001946, 52.0891}, {0.0007416, 0.00002202, 0.003486, 51.0323},
    {0.001368, 0.000039, 0.006450001, 49.9755}, {0.002236, 0.000064, 0.01054999, 52.3118},
    {0.004243, 0.00012, 0.02005001, 54.6482}, {0.00765, 0.000217, 0.03621, 68.7015},
    {0.01431, 0.000396, 0.06785001, 82.7549}, {0.02319, 0.00064, 0.1102, 87.1205}, {0.04351, 0.00121, 0.2074, 91.486},
    {0.07763, 0.00218, 0.3713, 92.4589}, {0.13438, 0.004, 0.6456, 93.4318}, {0.21477, 0.0073, 1.0390501, 90.0571},
    {0.2839, 0.0116, 1.3856, 86.6823}, {0.3285, 0.01684, 1.62296, 95.7737}, {0.34828, 0.023, 1.74706, 104.865},
    {0.34806, 0.0298, 1.7826, 110.9365}, {0.3362, 0.038, 1.77211, 117.008}, {0.3187, 0.048, 1.7441, 117.41},
    {0.2908, 0.06, 1.6692, 117.812}, {0.2511, 0.0739, 1.5281, 116.3365}, {0.19536, 0.09098, 1.28764, 114.861},
    {0.1421, 0.1126, 1.0419, 115.392}, {0.09564, 0.13902, 0.8129501, 115.923}, {0.05795001, 0.1693, 0.6162, 112.367},
    {0.03201, 0.20802, 0.46518, 108.811}, {0.0147, 0.2586, 0.3533, 109.0825}, {0.0049, 0.323, 0.272, 109.354},
    {0.0024, 0.4073, 0.2123, 108.578}, {0.0093, 0.503, 0.1582, 107.802}, {0.0291, 0.6082, 0.1117, 106.296},
    {0.06327, 0.71, 0.07824999, 104.79}, {0.1096, 0.7932, 0.05725001, 106.2395}, {0.1655, 0.862, 0.04216, 107.689},
    {0.2257499, 0.9148501, 0.02984, 106.047}, {0.2904, 0.954, 0.0203, 104.405}, {0.3597, 0.9803, 0.0134, 104.2255},
    {0.4334499, 0.9949501, 0.008749999, 104.046}, {0.5120501, 1.0, 0.005749999, 102.023}, {0.5945, 0.995, 0.0039, 100.0},
    {0.6784, 0.9786, 0.002749999, 98.1671}, {0.7621, 0.952, 0.0021, 96.3342}, {0.8425, 0.9154, 0.0018, 96.0611},
    {0.9163, 0.87, 0.001650001, 95.788}, {0.9786, 0.8163, 0.0014, 92.2368}, {1.0263, 0.757, 0.0011, 88.6856},
    {1.0567, 0.6949, 0.001, 89.3459}, {1.0622, 0.631, 0.0008, 90.0062}, {1.0456, 0.5668, 0.0006, 89.8026},
    {1.0026, 0.503, 0.00034, 89.5991}, {0.9384, 0.4412, 0.00024, 88.6489}, {0.8544499, 0.381, 0.00019, 87.6987},
    {0.7514, 0.321, 0.0001, 85.4937}, {0.6424, 0.265, 0.00004999999, 83.2886}, {0.5419, 0.217, 0.00003, 83.4939},
    {0.4479, 0.175, 0.00002, 83.6992}, {0.3608, 0.1382, 0.00001, 81.863}, {0.2835, 0.107, 0.0, 80.0268},
    {0.2187, 0.0816, 0.0, 80.1207}, {0.1649, 0.061, 0.0, 80.2146}, {0.1212, 0.04458, 0.0, 81.2462},
    {0.0874, 0.032, 0.0, 82.2778}, {0.0636, 0.0232, 0.0, 80.281}, {0.04677, 0.017, 0.0, 78.2842},
    {0.0329, 0.01192, 0.0, 74.0027}, {0.0227, 0.00821, 0.0, 69.7213}, {0.01584, 0.005723, 0.0, 70.6652},
    {0.01135916, 0.004102, 0.0, 71.6091}, {0.008110916, 0.002929, 0.0, 72.9791}, {0.005790346, 0.002091, 0.0, 74.349},
    {0.004109457, 0.001484, 0.0, 67.9765}, {0.002899327, 0.001047, 0.0, 61.604}, {0.00204919, 0.00074, 0.0, 65.7448},
    {0.001439971, 0.00052, 0.0, 69.8856}, {0.0009999493, 0.0003611, 0.0, 72.4863},
    {0.0006900786, 0.0002492, 0.0, 75.087}, {0.0004760213, 0.0001719, 0.0, 69.3398},
    {0.0003323011, 0.00012, 0.0, 63.5927}, {0.0002348261, 0.0000848, 0.0, 55.0054},
    {0.0001661505, 0.00006, 0.0, 46.4182}, {0.000117413, 0.0000424, 0.0, 56.6118},
    {0.00008307527, 0.00003, 0.0, 66.8054}, {0.00005870652, 0.0000212, 0.0, 65.0941},
    {0.00004150994, 0.00001499, 0.0, 63.3828}, {0.00002935326, 0.0000106, 0.0, 63.8434},
    {0.00002067383, 0.0000074657, 0.0, 64.304}, {0.00001455977, 0.0000052578, 0.0, 61.8779},
    {0.00001025398, 0.0000037029, 0.0, 59.4519}, {0.000007221456, 0.0000026078, 0.0, 55.7054},
    {0.000005085868, 0.0000018366, 0.0, 51.959}, {0.000003581652, 0.0000012934, 0.0, 54.6998},
    {0.000002522525, 0.00000091093, 0.0, 57.4406}, {0.000001776509, 0.00000064153, 0.0, 58.8766},
    {0.000001251141, 0.00000045181, 0.0, 60.3125}}};
// clang-format on

ObserverRow observer(double wavelength) {
    const double at = (wavelength - first_wavelength) / table_step;
    const auto i = std::min(static_cast<std::size_t>(at), table.size() - 2);
    const double t = at - static_cast<double>(i);
    const auto mix = [t](double a, double b) { return a + t * (b - a); };
    const ObserverRow &a = table[i], &b = table[i + 1];
    return {mix(a.x, b.x), mix(a.y, b.y), mix(a.z, b.z), mix(a.d65, b.d65)};
}

double value_at(const Spectrum& spectrum, double wavelength) {
    const std::vector<double>& wavelengths = spectrum.wavelengths;
    if (wavelength < wavelengths.front() || wavelength > wavelengths.back()) return 0.0;
    const auto above = std::upper_bound(wavelengths.begin() + 1, wavelengths.end() - 1, wavelength);
    const auto i = static_cast<std::size_t>(above - wavelengths.begin());
    const double t = (wavelength - wavelengths[i - 1]) / (wavelengths[i] - wavelengths[i - 1]);
    return spectrum.values[i - 1] + t * (spectrum.values[i] - spectrum.values[i - 1]);
}

/// CIE XYZ to linear sRGB (IEC 61966-2-1).
ColorD xyz_to_rgb(double x, double y, double z) {
    return {3.240479 * x - 1.537150 * y - 0.498535 * z, -0.969256 * x + 1.875991 * y + 0.041556 * z,
            0.055648 * x - 0.204043 * y + 1.057311 * z};
}

/// The colour under the light of relative power `illuminant(row)`, with Y = 1 for a value of 1 everywhere.
template <typename Illuminant>
ColorD to_rgb(const Spectrum& spectrum, Illuminant&& illuminant) {
    const double step = 0.5;  // nm, by the midpoint rule
    double x = 0.0, y = 0.0, z = 0.0, white = 0.0;
    for (double wavelength = first_wavelength + 0.5 * step; wavelength < last_wavelength; wavelength += step) {
        const ObserverRow row = observer(wavelength);
        const double light = illuminant(row), value = light * value_at(spectrum, wavelength);
        x += value * row.x;
        y += value * row.y;
        z += value * row.z;
        white += light * row.y;
    }
    const ColorD rgb = xyz_to_rgb(x / white, y / white, z / white);
    return {std::max(rgb.x, 0.0), std::max(rgb.y, 0.0), std::max(rgb.z, 0.0)};
}

}  // namespace

Spectrum parse_spectrum(const std::string& text, const std::string& place) {
    std::string spaced = text;
    std::replace(spaced.begin(), spaced.end(), ':', ' ');
    const std::vector<double> numbers = parse_numbers(spaced, place);
    const auto pairs = static_cast<std::size_t>(std::count(text.begin(), text.end(), ':'));
    if (pairs < 2 || numbers.size() != 2 * pairs)
        throw InputError(place, fmt::format("expected a spectrum as at least two pairs wavelength:value, got \"{}\"",
                                            excerpt(text)));
    Spectrum spectrum;
    for (std::size_t i = 0; i < pairs; ++i) {
        if (i > 0 && numbers[2 * i] <= numbers[2 * i - 2])
            throw InputError(
                place, fmt::format("expected rising wavelengths, got {} after {}", numbers[2 * i], numbers[2 * i - 2]));
        spectrum.wavelengths.push_back(numbers[2 * i]);
        spectrum.values.push_back(numbers[2 * i + 1]);
    }
    return spectrum;
}

ColorD rgb_under_d65(const Spectrum& spectrum) {
    return to_rgb(spectrum, [](const ObserverRow& row) { return row.d65; });
}

ColorD rgb_under_equal_energy(const Spectrum& spectrum) {
    return to_rgb(spectrum, [](const ObserverRow&) { return 1.0; });
}

ColorD equal_energy_white() {
    return xyz_to_rgb(1.0, 1.0, 1.0);
}

}  // namespace photonlab
