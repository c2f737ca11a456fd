// The records: one row per run, recorded pass and component, in CSV that pandas reads without being told anything. One
// table of columns makes the header and the rows.
//
// Numbers have the fewest digits that read back the same; what does not apply is empty.

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/files.h"
#include "experiment/kept_files.h"
#include "experiment/reference.h"
#include "render/pass_loop.h"
#include "image/image.h"
#include "image/metrics.h"

namespace photonlab {

/// What is the same in every row of a run.
struct RunIdentity {
    std::string experiment;
    std::string run;
    std::string scene;
    RunSettings settings;
    int width = 0;
    int height = 0;
    int samples_per_pixel = 1;
    std::uint64_t hit_points = 0;
};

/// One row.
struct Record {
    const RunIdentity& identity;
    const RunState& state;
    std::string_view component;
    std::optional<ErrorMetrics> errors;      ///< empty without a reference for this component
    std::optional<std::uint64_t> nonfinite;  ///< pixels of the component with a non-finite channel
    double peak_rss_mib = 0.0;
};

/// A pixel whose value is not finite.
struct NonfinitePixel {
    std::uint64_t pass = 0;
    std::string component;
    int x = 0;
    int y = 0;
};

/// The header line, without its end.
std::string csv_header();

/// A row, without its end.
std::string csv_row(const Record& record);

/// A value as it stands in a table: in quotes when it holds a comma, a quote or a line end, as RFC 4180 wants it. What
/// a spreadsheet would take for a formula, a text that begins with = + - @, a tab or a carriage return and is no
/// number, gets an apostrophe in front, as does what begins so behind apostrophes: whoever takes one away again has the
/// text back. [OWASP, "CSV Injection"]
std::string csv_cell(const std::string& text);

/// True when nothing but photons carries direct light in this method.
bool photons_carry_direct(const MethodSettings& settings);

/// Highest resident memory of the process since the last reset, MiB.
double peak_resident_mib();

/// Forgets earlier peaks, so that a run is not charged for the one before it. Where the system cannot do that, peaks
/// stay those of the whole process.
void reset_peak_resident();

/// Writes a run's rows as its passes finish.
class Recorder {
public:
    /// `reference` may be nullptr; it must outlive the recorder. The file is replaced by the first record().
    Recorder(RunIdentity identity, const Reference* reference, const std::filesystem::path& file);

    /// Appends the rows of a pass, one a component.
    void record(const RunState& state, const Image& image);

    /// Saves how far the file has grown and what was counted, or goes on from there.
    void exchange(StateArchive& archive);

    /// Of the file as it was written, whatever has become of it since.
    FileStamp stamp() const { return {file_.size(), file_.hash()}; }

    const RunIdentity& identity() const { return identity_; }
    std::uint64_t nonfinite_pixels() const { return nonfinite_count_; }  ///< summed over the rows of component total
    const std::vector<NonfinitePixel>& first_nonfinite_pixels() const { return first_nonfinite_; }
    const std::optional<ErrorMetrics>& last_total_errors() const { return last_total_; }

private:
    std::uint64_t count_nonfinite(const RunState& state, const Image& image, const std::string& component);

    RunIdentity identity_;
    const Reference* reference_;
    AppendedFile file_;
    double peak_ = 0.0;
    std::uint64_t nonfinite_count_ = 0;
    std::vector<NonfinitePixel> first_nonfinite_;
    std::optional<ErrorMetrics> last_total_;
};

}  // namespace photonlab
