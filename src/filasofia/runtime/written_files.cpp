#include "filasofia/runtime/written_files.h"

namespace filasofia::runtime {

void WrittenFiles::begin()
{
    pictures_.clear();
    pictureProblems_.clear();
    fileProblems_.clear();
}

void WrittenFiles::fill(RunReport& report) const
{
    report.pictures = pictures_;
    report.fileProblems = fileProblems_;
    report.fileProblems.insert(report.fileProblems.end(), pictureProblems_.begin(), pictureProblems_.end());
}

} // namespace filasofia::runtime
