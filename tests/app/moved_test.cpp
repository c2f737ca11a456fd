// The program and the image codecs, moved together into another folder.

#include <cstdlib>

#include "program.h"

namespace photonlab {
namespace {

class Moved : public ProgramTest {};

TEST_F(Moved, TheProgramFindsTheImageCodecsBesideItself) {
    const std::filesystem::path program = PHOTONLAB_PROGRAM;
    const std::filesystem::path codecs = PHOTONLAB_IMAGE_CODECS;
    const std::filesystem::path bin = folder_ / "bin";
    std::filesystem::create_directory(bin);
    std::filesystem::copy_file(program, bin / "photonlab");
    std::filesystem::copy_file(codecs, bin / codecs.filename());
    const std::string render = "'" + (bin / "photonlab").string() + "' render '" +
                               (folder_ / "walls/scene.xml").string() + "' -o '" + (folder_ / "a.exr").string() +
                               "' --png '" + (folder_ / "a.png").string() + "' --passes 1 --photons 10 > /dev/null";
    EXPECT_EQ(std::system(render.c_str()), 0);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "a.png"));
}

}  // namespace
}  // namespace photonlab
