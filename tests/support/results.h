// Comparing what two runs of the program left in their folders: everything but measured time and memory.

#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "core/files/files.h"
#include "core/files/json.h"
#include "image/exr.h"

namespace photonlab {

using Row = std::map<std::string, std::string>;

/// Rows by column, all of which must have every column. For tables without quoted commas.
inline std::vector<Row> read_rows(const std::filesystem::path& file) {
    const auto split = [](const std::string& line) {
        std::vector<std::string> cells{""};
        for (const char c : line) {
            if (c == ',')
                cells.emplace_back();
            else
                cells.back() += c;
        }
        return cells;
    };
    std::istringstream stream(read_text_file(file));
    std::string line;
    std::getline(stream, line);
    const std::vector<std::string> names = split(line);
    std::vector<Row> rows;
    while (std::getline(stream, line)) {
        const std::vector<std::string> cells = split(line);
        EXPECT_EQ(cells.size(), names.size()) << line;
        Row& row = rows.emplace_back();
        for (std::size_t i = 0; i < names.size(); ++i) row[names[i]] = i < cells.size() ? cells[i] : "(missing)";
    }
    return rows;
}

/// A table without the columns that are measured.
inline std::vector<Row> repeatable_rows(const std::filesystem::path& file) {
    auto rows = read_rows(file);
    for (auto& row : rows)
        std::erase_if(row, [](const auto& cell) {
            return cell.first.find("seconds") != std::string::npos || cell.first == "peak_rss_mib";
        });
    return rows;
}

/// Empty when the images have the same layers to the bit and the same metadata.
inline std::string difference_of_images(const std::filesystem::path& a, const std::filesystem::path& b) {
    Metadata metadata_a;
    Metadata metadata_b;
    const Image image_a = read_exr(a, &metadata_a);
    const Image image_b = read_exr(b, &metadata_b);
    if (metadata_a != metadata_b) return b.string() + ": other metadata";
    if (image_a.layers.size() != image_b.layers.size()) return b.string() + ": other layers";
    for (std::size_t i = 0; i < image_a.layers.size(); ++i)
        if (image_a.layers[i].name != image_b.layers[i].name || image_a.layers[i].pixels != image_b.layers[i].pixels)
            return b.string() + ": layer " + image_b.layers[i].name + " differs";
    return "";
}

/// Empty when every file of the folder `a` is in `b`, with the same content but for measured time and memory, and
/// nothing is left there of checkpoints and temporary files.
inline std::string difference_of_results(const std::filesystem::path& a, const std::filesystem::path& b) {
    std::string differences;
    std::set<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(a))
        if (entry.is_regular_file()) files.insert(std::filesystem::relative(entry.path(), a));
    for (const std::filesystem::path& file : files) {
        const std::string name = file.filename().string();
        std::string difference;
        if (name.find("checkpoint") != std::string::npos || name.find("partial") != std::string::npos)
            difference = (a / file).string() + ": is left over";
        else if (!std::filesystem::exists(b / file))
            difference = (b / file).string() + ": is missing";
        else if (file.extension() == ".exr")
            difference = difference_of_images(a / file, b / file);
        else if (file.extension() == ".csv" && repeatable_rows(a / file) != repeatable_rows(b / file))
            difference = (b / file).string() + ": other rows";
        else if (file.extension() == ".json") {
            Json json_a = Json::parse(read_text_file(a / file));
            Json json_b = Json::parse(read_text_file(b / file));
            for (const char* measured :
                 {"seconds", "started", "runs_together", "sessions", "resumed", "files", "checksum"}) {
                json_a.erase(measured);
                json_b.erase(measured);
            }
            if (json_a != json_b) difference = (b / file).string() + ": other content";
        }
        if (!difference.empty()) differences += difference + "\n";
    }
    return differences;
}

}  // namespace photonlab
