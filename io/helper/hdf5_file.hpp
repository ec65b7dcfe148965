// HDF5 files by libhdf5: groups, attributes, and where the chunks of a dataset lie in the file.
// Samples are not read here.
#pragma once

#include <hdf5.h>

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/chunked_image.hpp"

namespace palpate::io {

/// What libhdf5 opens, closed at the end of its life.
class Hdf5Handle {
  public:
    using Close = herr_t (*)(hid_t);
    Hdf5Handle(hid_t id, Close close) : id_(id), close_(close) {}
    ~Hdf5Handle() {
        if (id_ >= 0) close_(id_);
    }
    Hdf5Handle(Hdf5Handle&& other) noexcept : id_(other.id_), close_(other.close_) {
        other.id_ = -1;
    }
    Hdf5Handle& operator=(Hdf5Handle&&) = delete;
    operator hid_t() const { return id_; }
    bool is_open() const { return id_ >= 0; }

  private:
    hid_t id_;
    Close close_;
};

/// Makes files that are opened with this access list the one that lies elsewhere (far_file.hpp),
/// whatever their name. False if libhdf5 refuses.
bool use_far_driver(hid_t access);

/// Functions throw Failure.
class Hdf5File {
  public:
    explicit Hdf5File(const std::filesystem::path& path);

    /// True if each part of a path, which begins at the root, is there.
    bool has(const std::string& path) const;
    /// Of all groups and datasets at the root.
    std::vector<std::string> names() const;
    /// How many of PREFIX0, PREFIX1, ... there are: `name` makes each from its number.
    int count(const std::function<std::string(int)>& name) const;
    /// An attribute that is a text, a list of characters, as Imaris writes it, or a number; empty
    /// if there is none.
    std::string text(const std::string& object, const char* attribute) const;
    /// The same as a number.
    std::optional<double> number(const std::string& object, const char* attribute) const;
    /// A small dataset as numbers, row by row.
    std::vector<double> numbers(const std::string& dataset) const;

    /// Everything but its place in space; `dataset` becomes its id.
    ImageArray array(const std::string& dataset) const;
    /// Where some chunks of it lie: from `first` on, so many along each axis.
    void places(const std::string& dataset, const std::array<std::int64_t, 3>& first,
                const std::array<std::int64_t, 3>& count, std::span<ChunkPlace> places) const;

  private:
    Hdf5Handle open_dataset(const std::string& path) const;

    Hdf5Handle file_;
    unsigned long number_ = 0;  ///< by which objects of other files are told apart
};

}  // namespace palpate::io
