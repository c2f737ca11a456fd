#include "image/codecs/image_codecs.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/mman.h>

#include "core/error.h"
#include "core/machine/available_memory.h"

namespace photonlab {

namespace {

/// Some of what OpenImageIO is linked with starts threads while it is loaded, and waits for ever, or ends the program,
/// where there is no room for them: so there must be room for all of it beforehand. As measured, 450 MiB of addresses.
void require_addresses() {
    constexpr std::size_t mebibytes = 512;
    void* place = ::mmap(nullptr, mebibytes << 20, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (place == MAP_FAILED)
        throw InputError(PHOTONLAB_IMAGE_CODECS, fmt::format("cannot be loaded: needs {} MiB of addresses, and {}",
                                                             mebibytes, describe(available_memory())));
    ::munmap(place, mebibytes << 20);
}

const ImageCodecs& load() {
    require_addresses();
    void* library = dlopen(PHOTONLAB_IMAGE_CODECS, RTLD_LAZY | RTLD_LOCAL);
    const void* symbol = library ? dlsym(library, "photonlab_image_codecs") : nullptr;
    if (!symbol) throw InputError(PHOTONLAB_IMAGE_CODECS, std::string("cannot be loaded: ") + dlerror());
    return *static_cast<const ImageCodecs*>(symbol);
}

}  // namespace

const ImageCodecs& image_codecs() {
    static const ImageCodecs& codecs = load();
    return codecs;
}

}  // namespace photonlab
