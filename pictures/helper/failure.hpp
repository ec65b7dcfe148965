// The error that a picture cannot be drawn, with a message for the user.
#pragma once

#include <stdexcept>

namespace palpate::pictures {

class Failure : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

}  // namespace palpate::pictures
