#include "render/photon_supply.h"

namespace photonlab {

void PhotonSupply::begin_pass(PhotonPass photons) {
    pass_ = std::move(photons);
}

void PhotonSupply::index_pass() {
    pass_map_.emplace(std::move(pass_.photons), std::move(pass_.notes));
}

void PhotonSupply::end_pass() {
    pass_map_.reset();
    pass_ = {};
}

void PhotonSupply::add_pass() {
    for (const Photon& photon : pass_.photons) (photon.caustic ? caustic_ : global_).push_back(photon);
    all_paths_ += pass_.paths_emitted;
}

void PhotonSupply::index_all_passes() {
    global_map_.emplace(global_);
    caustic_map_.emplace(caustic_);
}

void PhotonSupply::drop_maps_of_all_passes() {
    global_map_.reset();
    caustic_map_.reset();
}

std::uint64_t PhotonSupply::bytes_of_all_passes() const {
    const std::uint64_t maps = (global_map_ ? global_map_->bytes() : 0) + (caustic_map_ ? caustic_map_->bytes() : 0);
    return (global_.capacity() + caustic_.capacity()) * sizeof(Photon) + maps;
}

}  // namespace photonlab
