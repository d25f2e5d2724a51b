#pragma once

#include "filasofia/visual/image.h"

#include <string>

/// Compares a picture with tests/visual/pictures/<name>.png: at most one pixel in a thousand may differ by more than
/// 2/255 in a colour. If it fails, the picture is written into the build folder. With FILASOFIA_UPDATE_PICTURES=1 in
/// the environment it becomes the reference instead: look at it before it is committed.
void checkPicture(const filasofia::visual::Image& image, const std::string& name);
