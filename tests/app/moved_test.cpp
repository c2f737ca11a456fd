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
    // A texture that only the codecs read: a Targa of one pixel.
    folder_.write("textured/grey.tga", std::string("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\30\0\200\200\200", 21));
    folder_.write("textured/scene.xml",
                  "<scene version='3.0.0'><sensor type='perspective'/><shape type='rectangle'><bsdf type='diffuse'>"
                  "<texture type='bitmap' name='reflectance'><string name='filename' value='grey.tga'/></texture>"
                  "</bsdf></shape></scene>");
    const std::string info =
        "'" + (bin / "photonlab").string() + "' info '" + (folder_ / "textured/scene.xml").string() + "' > /dev/null";
    EXPECT_EQ(std::system(info.c_str()), 0);
    std::filesystem::remove(bin / codecs.filename());
    EXPECT_NE(std::system((info + " 2>&1").c_str()), 0) << "it read the texture without them";
}

}  // namespace
}  // namespace photonlab
