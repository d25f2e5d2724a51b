#include "little_scene.h"

#include "filasofia/core/error.h"
#include "filasofia/visual/jpeg.h"

#include <stb/stb_image.h>

#include <sys/resource.h>

#include <csignal>

namespace image_test {

using namespace filasofia;
using namespace filasofia::visual;

namespace {

Image checkers()
{
    Image image{3, 2, {}};
    for (int i = 0; i < 6; ++i)
        for (int k : {40 * i, 255 - 40 * i, i, 0}) image.rgba.push_back(std::uint8_t(k));
    return image;
}

} // namespace

TEST_CASE("a picture comes back from its file")
{
    const std::string file = std::string(FILASOFIA_BINARY_DIR) + "/picture_test.png";
    const Image image = checkers();
    savePng(image, file);
    int width = 0, height = 0, channels = 0;
    unsigned char* read = stbi_load(file.c_str(), &width, &height, &channels, 4);
    REQUIRE(read);
    CHECK(width == 3);
    CHECK(height == 2);
    CHECK(channels == 3);
    for (std::size_t i = 0; i < 24; ++i) CHECK(read[i] == (i % 4 == 3 ? 255 : image.rgba[i]));
    stbi_image_free(read);
    CHECK(image.pixel(1, 1)[0] == 160);
}

TEST_CASE("a picture that cannot be written is an error that names the file")
{
    using Catch::Contains;
    CHECK_THROWS_WITH(savePng(checkers(), "/no/such/folder/picture.png"), Contains("/no/such/folder/picture.png"));
    CHECK_THROWS_WITH(savePng(checkers(), "/dev/full"), Contains("/dev/full")); // can be opened, but has no room
    CHECK_THROWS_WITH(savePng(Image{}, "empty.png"), Contains("empty.png"));
    Image torn = checkers();
    torn.rgba.pop_back();
    CHECK_THROWS_WITH(savePng(torn, "torn.png"), Contains("torn.png"));
    CHECK_THROWS_AS(savePng(Image{-1, -1, {}}, "negative.png"), Error);
}

TEST_CASE("a JPEG has the size and nearly the colours of its picture, and what cannot be one is refused")
{
    const Image image{16, 8, std::vector<std::uint8_t>(4 * 16 * 8, 130)};
    const std::string jpeg = encodeJpeg(16, 8, image.rgba);
    int width = 0, height = 0, channels = 0;
    const auto* bytes = reinterpret_cast<const unsigned char*>(jpeg.data());
    unsigned char* read = stbi_load_from_memory(bytes, int(jpeg.size()), &width, &height, &channels, 4);
    REQUIRE(read);
    CHECK(width == 16);
    CHECK(height == 8);
    for (int i = 0; i < 3; ++i) CHECK(std::abs(int(read[i]) - 130) < 4);
    stbi_image_free(read);
    CHECK(encodeJpeg(3, 2, checkers().rgba, 100).size() > encodeJpeg(3, 2, checkers().rgba, 1).size());
    CHECK_THROWS_WITH(encodeJpeg(16, 9, image.rgba),
                      "JPEG: a picture of 16 x 9 pixels with 512 bytes cannot be encoded");
    CHECK_THROWS_AS(encodeJpeg(-16, -8, image.rgba), Error);
    CHECK_THROWS_WITH(encodeJpeg(16, 8, image.rgba, 101), "JPEG: quality must be in [1, 100], got 101");
}

TEST_CASE("a picture without room leaves what was there, and no half file")
{
    const std::filesystem::path file = std::string(FILASOFIA_BINARY_DIR) + "/no_room_test.png";
    savePng(checkers(), file);
    const auto size = std::filesystem::file_size(file);
    rlimit before{};
    REQUIRE(getrlimit(RLIMIT_FSIZE, &before) == 0);
    const auto signalled = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{10, before.rlim_max};
    REQUIRE(setrlimit(RLIMIT_FSIZE, &small) == 0);
    std::string problem;
    try {
        savePng(checkers(), file);
    } catch (const Error& error) {
        problem = error.what();
    }
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, signalled);
    CHECK(problem == file.string() + ": cannot be written (File too large)");
    CHECK(std::filesystem::file_size(file) == size);
    CHECK_FALSE(std::filesystem::exists(file.string() + ".part"));
    std::filesystem::remove(file);
}

} // namespace image_test
