// Why a picture cannot be drawn, in words for the one who asked for it.
#pragma once

#include <stdexcept>

namespace palpate::pictures {

class Failure : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

}  // namespace palpate::pictures
