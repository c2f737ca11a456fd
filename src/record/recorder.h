// Writes a run's records (columns.h) as its passes finish.

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/files/files.h"
#include "core/files/kept_files.h"
#include "image/image.h"
#include "record/columns.h"
#include "reference/reference.h"

namespace photonlab {

/// A pixel whose value is not finite.
struct NonfinitePixel {
    std::uint64_t pass = 0;
    std::string component;
    int x = 0;
    int y = 0;
};

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
    /// `reference` may be nullptr; it must outlive the recorder. The file is replaced by the first record(); without a
    /// name rows are not kept.
    Recorder(RunIdentity identity, const Reference* reference, const std::filesystem::path& file);

    /// Appends the rows of a pass, one a component.
    void record(const RunState& state, const Image& image);

    /// Saves how far the file has grown and what was counted, or goes on from there.
    void exchange(StateArchive& archive);

    /// Of the file as it was written, whatever has become of it since.
    FileStamp stamp() const { return file_ ? FileStamp{file_->size(), file_->hash()} : FileStamp{}; }

    const RunIdentity& identity() const { return identity_; }
    std::uint64_t nonfinite_pixels() const { return nonfinite_count_; }  ///< summed over the rows of component total
    const std::vector<NonfinitePixel>& first_nonfinite_pixels() const { return first_nonfinite_; }
    const std::optional<ErrorMetrics>& last_total_errors() const { return last_total_; }

private:
    std::uint64_t count_nonfinite(const RunState& state, const Image& image, const std::string& component);

    RunIdentity identity_;
    const Reference* reference_;
    std::optional<AppendedFile> file_;
    double peak_ = 0.0;
    std::uint64_t nonfinite_count_ = 0;
    std::vector<NonfinitePixel> first_nonfinite_;
    std::optional<ErrorMetrics> last_total_;
};

}  // namespace photonlab
