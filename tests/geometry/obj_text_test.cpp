#include "filasofia/geometry/obj_text.h"

#include "geometry/sample_meshes.h"

namespace obj_text_test {

using namespace filasofia;
using namespace filasofia::geometry;
using Catch::Matchers::Contains;

namespace {

std::string errorIn(std::string_view bytes)
{
    return errorOf([&] { (void)checkedObj(bytes, "a.obj"); });
}

} // namespace

TEST_CASE("an OBJ file is given to assimp in words that it reads right")
{
    CHECK(checkedObj("\xef\xbb\xbfv .5\t-.5 +.5 # a comment\r\nvt .5\r\nvn 0 0 1\n", "a.obj") ==
          "v 0.5 -.5 +.5\nvt 0.5 0\nvn 0 0 1\n");
    CHECK(checkedObj("v 1 2 3 .5\nv 1 2 3 0 0 .1\nv 1 \\\n 2 3\nf 1 \\\r\n2 3", "a.obj") ==
          "v 1 2 3 0.5\nv 1 2 3 0 0 0.1\nv 1 2 3\nf 1 2 3\n");
    const std::string_view rest = "mtllib a#1.mtl\no a .5 part\ns off\n\n# f 9 9 9\nl 1 2\n";
    CHECK(checkedObj(rest, "a.obj") == rest);
}

TEST_CASE("vertices and faces of an OBJ file that are none are refused with their line")
{
    const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    CHECK_THAT(errorIn("v 0 0\n"),
               Contains("a.obj:1: 'v' must have 3 numbers (with a weight 4, with a colour 6), got 2"));
    CHECK_THAT(errorIn("v 0 0 0 0 0\n"), Contains("a.obj:1: 'v' must have 3 numbers") && Contains("got 5"));
    CHECK_THAT(errorIn("v 0 0 0 0\n"), Contains("a.obj:1: the weight of a vertex must not be 0"));
    CHECK_THAT(errorIn(three + "vn 0 1\n"), Contains("a.obj:4: 'vn' must have 3 numbers, got 2"));
    CHECK_THAT(errorIn(three + "vt\n"), Contains("a.obj:4: 'vt' must have 1 to 3 numbers, got 0"));
    CHECK_THAT(errorIn(three + "f 1 2 0\n"),
               Contains("a.obj:4: a face names number 0 of the vertices; they count from 1"));
    CHECK_THAT(errorIn(three + "f 1 2 -4\n"),
               Contains("a.obj:4: a face names number -4 of the vertices; so far the file has 3"));
    CHECK_THAT(errorIn("f 1 2 4\n" + three),
               Contains("a.obj:1: a face names number 4 of the vertices; the file has 3"));
    CHECK_THAT(errorIn(three + "f 1/1 2/1 3/1\n"),
               Contains("a.obj:4: a face names number 1 of the texture coordinates; the file has 0"));
    CHECK_THAT(errorIn(three + "f 1//1 2//1 3//1\n"),
               Contains("a.obj:4: a face names number 1 of the normals; the file has 0"));
    CHECK_THAT(errorIn(three + "vt 0 0\nf 1/1 2 3/1\n"),
               Contains("a.obj:5: all corners of a face must name texture coordinates, or none, got '2'"));
    for (const char* corner : {"1/", "1//", "1/1/1/1", "/1", "1/1/"})
        CHECK_THAT(errorIn(three + "vt 0 0\nvn 0 0 1\nf 1 2 " + corner + "\n"),
                   Contains("a.obj:6: a corner of a face must be v, v/vt, v//vn or v/vt/vn in whole numbers, got '" +
                            std::string(corner) + "'"));
    CHECK_THAT(errorIn(three + "f 1 2 3.0\n"),
               Contains("a.obj:4: a corner of a face must be a whole number, got '3.0'"));
    CHECK_THAT(errorIn(three + "f\n"), Contains("a.obj:4: a face must name at least 1 vertex, got 0"));
    CHECK(errorIn("f 1 2 3\n" + three + "f -1 -2 -3\n").empty());
}

} // namespace obj_text_test
