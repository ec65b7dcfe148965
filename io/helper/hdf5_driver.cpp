// A virtual file driver over far_file.hpp: "HDF5 Virtual File Layer", H5FDpublic.h of 1.10.
#include <algorithm>
#include <new>

#include "io/helper/far_file.hpp"
#include "io/helper/hdf5_file.hpp"

namespace palpate::io {
namespace {

struct FarFile {
    H5FD_t head;  // first: libhdf5 knows this part
    haddr_t end_of_allocation = 0;
};

H5FD_t* open_far(const char*, unsigned flags, hid_t, haddr_t) {
    if ((flags & H5F_ACC_RDWR) != 0) return nullptr;
    auto* file = new (std::nothrow) FarFile{};
    return file ? &file->head : nullptr;
}
herr_t close_far(H5FD_t* file) {
    delete reinterpret_cast<FarFile*>(file);
    return 0;
}
herr_t query_far(const H5FD_t*, unsigned long* flags) {
    if (flags) *flags = H5FD_FEAT_DATA_SIEVE | H5FD_FEAT_AGGREGATE_METADATA;
    return 0;
}
haddr_t end_of_allocation(const H5FD_t* file, H5FD_mem_t) {
    return reinterpret_cast<const FarFile*>(file)->end_of_allocation;
}
herr_t set_end_of_allocation(H5FD_t* file, H5FD_mem_t, haddr_t address) {
    reinterpret_cast<FarFile*>(file)->end_of_allocation = address;
    return 0;
}
haddr_t end_of_file(const H5FD_t*, H5FD_mem_t) {
    return far_size();
}
herr_t read_part(H5FD_t*, H5FD_mem_t, hid_t, haddr_t address, std::size_t size, void* to) {
    return read_far(address, {static_cast<std::byte*>(to), size}) ? 0 : -1;
}
herr_t refuse_to_write(H5FD_t*, H5FD_mem_t, hid_t, haddr_t, std::size_t, const void*) {
    return -1;
}

H5FD_class_t driver_class() {
    H5FD_class_t driver{};
    driver.name = "far";
    driver.maxaddr = (haddr_t{1} << 62) - 1;
    driver.fc_degree = H5F_CLOSE_WEAK;
    driver.open = open_far;
    driver.close = close_far;
    driver.query = query_far;
    driver.get_eoa = end_of_allocation;
    driver.set_eoa = set_end_of_allocation;
    driver.get_eof = end_of_file;
    driver.read = read_part;
    driver.write = refuse_to_write;
    const H5FD_mem_t one_kind[] = H5FD_FLMAP_SINGLE;
    std::ranges::copy(one_kind, driver.fl_map);
    return driver;
}

}  // namespace

bool use_far_driver(hid_t access) {
    static const H5FD_class_t driver = driver_class();
    static const hid_t id = H5FDregister(&driver);
    return id >= 0 && H5Pset_driver(access, id, nullptr) >= 0;
}

}  // namespace palpate::io
