#include "filasofia/runtime/written_files.h"

#include "filasofia/core/log.h"
#include "filasofia/visual/image.h"

namespace filasofia::runtime {

void WrittenFiles::begin()
{
    pictures_.clear();
    pictureProblems_.clear();
    fileProblems_.clear();
}

void WrittenFiles::savePicture(const visual::Image& image, const std::string& file)
{
    if (attempt([&] { visual::savePng(image, file); })) addPicture(file);
}

void WrittenFiles::keep(const Error& problem)
{
    logError(problem.what());
    pictureProblems_.emplace_back(problem.what());
}

void WrittenFiles::fill(RunReport& report) const
{
    report.pictures = pictures_;
    report.fileProblems = fileProblems_;
    report.fileProblems.insert(report.fileProblems.end(), pictureProblems_.begin(), pictureProblems_.end());
}

} // namespace filasofia::runtime
