#include "image/image_codecs.h"

#include <dlfcn.h>

#include "core/error.h"

namespace photonlab {

namespace {

const ImageCodecs& load() {
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
