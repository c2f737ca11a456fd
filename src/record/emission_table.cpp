#include "record/emission_table.h"

#include <fmt/format.h>

namespace photonlab {

std::string emission_table(const Scene& scene, const EmissionMap& map) {
    std::string table = "light,kind,square,row,column,plain,probability,paths,acceptances\n";
    for (std::size_t cell = 0; cell < map.cell_count(); ++cell) {
        const std::size_t light = cell / EmissionMap::cells_per_light;
        const std::size_t place = cell % EmissionMap::cells_per_light;
        table +=
            fmt::format("{},{},{},{},{},{},{},{},{}\n", light, emitter_kind(scene.emitters[light]),
                        map.square(light) == EmissionMap::Square::Direction ? "direction" : "position",
                        place / EmissionMap::cells_per_side, place % EmissionMap::cells_per_side,
                        map.plain_probability(cell), map.probability(cell), map.paths(cell), map.acceptances(cell));
    }
    return table;
}

}  // namespace photonlab
