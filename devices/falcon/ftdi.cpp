// Finds the functions of libftdi 1.
#include "devices/falcon/ftdi.hpp"

#include "devices/falcon/port.hpp"

namespace palpate::devices::falcon {

Ftdi::Ftdi(const std::string& path) : library(path, words()) {
    library.need(make, "ftdi_new");
    library.need(free, "ftdi_free");
    library.need(find_all, "ftdi_usb_find_all");
    library.need(free_list, "ftdi_list_free");
    library.need(open, "ftdi_usb_open_desc_index");
    library.need(close, "ftdi_usb_close");
    library.need(reset, "ftdi_usb_reset");
    library.need(set_baud_rate, "ftdi_set_baudrate");
    library.need(set_line, "ftdi_set_line_property");
    library.need(set_flow_control, "ftdi_setflowctrl");
    library.need(set_dtr, "ftdi_setdtr");
    library.need(set_rts, "ftdi_setrts");
    library.need(set_latency, "ftdi_set_latency_timer");
    library.need(read, "ftdi_read_data");
    library.need(write, "ftdi_write_data");
    library.need(error_text, "ftdi_get_error_string");
}

int Ftdi::count() const {
    void* const context = make();
    if (!context) return -1;
    void* list = nullptr;
    const int found = find_all(context, &list, vendor_id, product_id);
    if (list) free_list(&list);
    free(context);
    return found;
}

}  // namespace palpate::devices::falcon
