#include "cut_block.h"

#include "filasofia/geometry/surface.h"
#include "filasofia/runtime/stepped_run.h"
#include "skip.h"

#include <numbers>

namespace wound_picture_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

/// From above onto the block, with the light beside the lens.
PictureDef fromAbove()
{
    return {.width = 320,
            .height = 240,
            .pose = visual::lookAt({0.0, 0.07, 0.0001}, {}),
            .camera = CameraDef{.verticalFieldOfView = 0.6, .near = 0.005, .far = 1.0}};
}

double luminance(const visual::Image& image, int x, int y)
{
    const auto p = image.pixel(x, y);
    return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
}

/// How much darker a row of the picture has become, [-] as a share, in the middle half of its columns.
double darkened(const visual::Image& before, const visual::Image& after, int row)
{
    double was = 0.0, is = 0.0;
    for (int x = before.width / 4; x < 3 * before.width / 4; ++x) {
        was += luminance(before, x, row);
        is += luminance(after, x, row);
    }
    return 1.0 - is / was;
}

} // namespace

TEST_CASE("a cut whose faces are still together shows as a dark line, and only there")
{
    if (skipIf(!visual::hasBackend(Backend::Headless), "this build draws nothing")) return;
    for (const bool finer : {false, true}) { // the body's own boundary, and a skin in finer detail
        for (const int subdivision : {0, 1}) {
            INFO("finer skin " << finer << ", subdivision " << subdivision);
            CutBlock block(1, {10, 3, 7});
            ShowDef show{.subdivision = subdivision};
            if (finer)
                show.surface = std::make_shared<const geometry::TriangleMesh>(
                    geometry::extractSurface(*shapes::block({40_mm, 12_mm, 30_mm}, {25, 6, 19})).mesh);
            block.sim.show(block.tissue, show);
            block.sim.physics().setGravity({});
            SteppedRun run(block.sim);
            for (int i = 0; i < 5; ++i) run.step();
            const visual::Image before = run.picture(fromAbove());
            for (int i = 0; i < 120; ++i) run.step();
            block.sim.physics().setPose(block.knife, {{0, 0.5, 0}, CutBlock::upright()});
            for (int i = 0; i < 5; ++i) run.step();
            const visual::Image after = run.picture(fromAbove());
            visual::savePng(after, FILASOFIA_BINARY_DIR "/closed_cut.png"); // for a person to look at
            double most = -1.0;
            int line = 0;
            for (int row = 60; row < 180; ++row)
                if (const double here = darkened(before, after, row); here > most) {
                    most = here;
                    line = row;
                }
            CHECK(std::abs(line - 120) <= 3); // the cut goes through the middle
            CHECK(most > 0.3);
            for (int row = 60; row < 180; ++row) {
                if (std::abs(row - line) < 12) continue;
                CHECK(std::abs(darkened(before, after, row)) < 0.05);
            }
        }
    }
}

} // namespace wound_picture_test
