#pragma once

#include "filasofia/visual/image.h"

#include <filesystem>
#include <string>

/// Comparison of pictures with references that are part of the source.
namespace filasofia::visual {

/// Fails the test unless at most 0.1 % of the pixels differ by more than 2/255 in a colour from
/// tests/visual/pictures/<name>.png. On failure the picture and the difference are written beside the test program.
/// With FILASOFIA_UPDATE_PICTURES=1 in the environment it writes the reference instead.
void checkPicture(const Image& image, const std::string& name);

/// The fraction of pixels that differ by more than `tolerance` 255ths in a colour; 1 if the sizes differ.
double differingShare(const Image& a, const Image& b, int tolerance = 2);

} // namespace filasofia::visual
