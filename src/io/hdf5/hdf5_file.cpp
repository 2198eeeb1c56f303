// An HDF5 file's data sets, groups and attributes by name.
#include "src/io/hdf5/hdf5_file.h"

#include "src/core/error.h"
#include "src/io/file_lock.h"
#include "src/io/hdf5/hdf5_library.h"
#include "src/io/input_file.h"

#include <mutex>

namespace eventide {
namespace {

using Lock = std::lock_guard<std::recursive_mutex>;

/// Of a group or data set; not good() where there is none.
Hdf5Handle attribute_of(const Hdf5Handle& file, const std::string& object,
                        const std::string& name) {
    const Hdf5Library& h5 = hdf5();
    const Hdf5Handle opened{h5.H5Gopen2(file.id(), object.c_str(), H5P_DEFAULT), h5.H5Gclose};
    if (!opened.good() || h5.H5Aexists(opened.id(), name.c_str()) <= 0) return {};
    return {h5.H5Aopen(opened.id(), name.c_str(), H5P_DEFAULT), h5.H5Aclose};
}

}  // namespace

Hdf5File::Hdf5File(const std::string& path) : path_(path) {
    open_to_read(path);  // for the system's own words
    const Lock lock{hdf5_mutex()};
    const Hdf5Library& h5 = hdf5();
    file_ = {h5.H5Fopen(path.c_str(), kHdf5ReadOnly, H5P_DEFAULT), h5.H5Fclose};
    if (file_.good()) return;
    throw Error(ErrorKind::input,
                path_ + (is_locked(path)
                             ? ": expected an HDF5 file that nobody writes, found one that another "
                               "program has locked; HDF5_USE_FILE_LOCKING=FALSE in the environment "
                               "reads what it holds by now"
                             : ": expected an HDF5 file, found one that is cut short or damaged"));
}

bool Hdf5File::has(const std::string& name) const {
    const Lock lock{hdf5_mutex()};
    const Hdf5Library& h5 = hdf5();
    // The way there has to be walked.
    for (std::size_t at = name.find('/'); at != name.npos; at = name.find('/', at + 1))
        if (at > 0 && h5.H5Lexists(file_.id(), name.substr(0, at).c_str(), H5P_DEFAULT) <= 0)
            return false;
    return h5.H5Lexists(file_.id(), name.c_str(), H5P_DEFAULT) > 0 &&
           h5.H5Oexists_by_name(file_.id(), name.c_str(), H5P_DEFAULT) > 0;
}

Hdf5Data Hdf5File::data(const std::string& name) const {
    const Lock lock{hdf5_mutex()};
    Hdf5Data data{path_ + ": " + name};
    if (!has(name)) data.refuse("a data set", "none");
    data.open(file_.id(), name);
    return data;
}

std::vector<std::string> Hdf5File::names_in(const std::string& group) const {
    const Lock lock{hdf5_mutex()};
    const Hdf5Library& h5 = hdf5();
    const Hdf5Handle opened{h5.H5Gopen2(file_.id(), group.c_str(), H5P_DEFAULT), h5.H5Gclose};
    H5G_info_t facts{};
    std::vector<std::string> names;
    if (!opened.good() || h5.H5Gget_info(opened.id(), &facts) < 0) return names;
    for (hsize_t i = 0; i < facts.nlinks; ++i) {
        char name[256];
        const ssize_t length = h5.H5Lget_name_by_idx(opened.id(), ".", H5_INDEX_NAME, H5_ITER_INC,
                                                     i, name, sizeof name, H5P_DEFAULT);
        if (length < 0) break;
        if (std::size_t(length) < sizeof name) names.emplace_back(name);
    }
    return names;
}

std::vector<double> Hdf5File::number_attributes(const std::string& object,
                                                const std::string& name) const {
    const Lock lock{hdf5_mutex()};
    const Hdf5Library& h5 = hdf5();
    const Hdf5Handle attribute = attribute_of(file_, object, name);
    if (!attribute.good()) return {};
    const Hdf5Handle space{h5.H5Aget_space(attribute.id()), h5.H5Sclose};
    constexpr hssize_t kMax = 16;
    const hssize_t count = space.good() ? h5.H5Sget_simple_extent_npoints(space.id()) : 0;
    if (count < 1 || count > kMax) return {};
    std::vector<double> values(static_cast<std::size_t>(count));
    if (h5.H5Aread(attribute.id(), h5.H5T_NATIVE_DOUBLE_g, values.data()) < 0) return {};
    return values;
}

std::string Hdf5File::text_attribute(const std::string& object, const std::string& name) const {
    const Lock lock{hdf5_mutex()};
    const Hdf5Library& h5 = hdf5();
    const Hdf5Handle attribute = attribute_of(file_, object, name);
    if (!attribute.good()) return {};
    const Hdf5Handle type{h5.H5Aget_type(attribute.id()), h5.H5Tclose};
    const Hdf5Handle space{h5.H5Aget_space(attribute.id()), h5.H5Sclose};
    constexpr std::size_t kLongest = 256;
    if (!type.good() || !space.good() || h5.H5Tget_class(type.id()) != H5T_STRING ||
        h5.H5Sget_simple_extent_npoints(space.id()) != 1)
        return {};
    // Text of any length is told by its address.
    if (h5.H5Tis_variable_str(type.id()) > 0) {
        char* text = nullptr;
        if (h5.H5Aread(attribute.id(), type.id(), &text) < 0 || text == nullptr) return {};
        std::string copy = std::string(text).substr(0, kLongest);
        h5.H5free_memory(text);
        return copy;
    }
    const std::size_t size = h5.H5Tget_size(type.id());
    if (size > kLongest) return {};
    std::string text(size, '\0');
    if (h5.H5Aread(attribute.id(), type.id(), text.data()) < 0) return {};
    return text.substr(0, text.find('\0'));
}

}  // namespace eventide
