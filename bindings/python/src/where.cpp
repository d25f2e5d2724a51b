#include "where.h"

#include "filasofia/core/word.h"

namespace filasofia::python {

std::string Where::text() const
{
    if (!outer) return std::string(name);
    const std::string before = outer->text();
    if (name.empty()) return filasofia::text(before, "[", index, "]");
    return filasofia::text(before, outer->outer ? "." : ": ", name);
}

std::string withArticle(std::string_view noun)
{
    const bool vowel = std::string_view("AEIOU").find(noun.front()) != std::string_view::npos;
    return filasofia::text(vowel ? "an " : "a ", noun);
}

std::string wordsOf(nb::handle value) { return nb::cast<std::string>(nb::str(value)); }

std::string shown(nb::handle value)
{
    PyObject* words = PyObject_Repr(value.ptr());
    if (!words) {
        PyErr_Clear(); // a repr of the user's that fails must not hide the error that is to be told
        return filasofia::text("a ", wordsOf(nb::object(nb::handle(Py_TYPE(value.ptr())).attr("__name__"))));
    }
    const nb::object held = nb::steal(words);
    Py_ssize_t size = 0;
    const char* letters = PyUnicode_AsUTF8AndSize(words, &size);
    if (!letters) {
        PyErr_Clear(); // lone surrogates
        return "a value that cannot be printed";
    }
    return shortened(oneLine(std::string(letters, static_cast<std::size_t>(size))));
}

void failValue(const Where& where, std::string_view must, nb::handle got)
{
    throw PythonError(filasofia::text(where.text(), " ", must, ", got ", shown(got)));
}

void failType(const Where& where, std::string_view must, nb::handle got)
{
    throw nb::type_error(filasofia::text(where.text(), " ", must, ", got ", shown(got)).c_str());
}

} // namespace filasofia::python
