#!/usr/bin/python3
"""A file dialog of a desktop, played: answers FileChooser calls as their title says.

Prints "ready", then each call's options as a line of JSON."""
import json
import sys

import dbus
import dbus.mainloop.glib
import dbus.service
from gi.repository import GLib


def plain(value):
    if isinstance(value, dbus.Array) and value.signature == "y":
        return bytes(value).decode()
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    if isinstance(value, dbus.Boolean):
        return bool(value)
    return int(value) if isinstance(value, int) else str(value)


class Request(dbus.service.Object):
    @dbus.service.signal("org.freedesktop.portal.Request", signature="ua{sv}")
    def Response(self, code, results):
        pass

    @dbus.service.method("org.freedesktop.portal.Request")
    def Close(self):
        print(json.dumps({"closed": True}), flush=True)


class Portal(dbus.service.Object):
    def answer(self, member, sender, parent, title, options):
        print(json.dumps({"member": member, "parent": str(parent), "title": str(title),
                          "options": plain(options)}), flush=True)
        path = "/org/freedesktop/portal/desktop/request/%s/%s" % (
            sender[1:].replace(".", "_"), options["handle_token"])
        request = Request(self.connection, path)
        uris = dbus.Array(["file:///tmp/a%20scan.ply"], signature="s")
        response = {"choose": (0, {"choices": dbus.Array([], signature="(ss)"), "uris": uris}),
                    "cancel": (1, {}), "break": (2, {})}.get(title)
        if response:
            GLib.timeout_add(30, lambda: request.Response(dbus.UInt32(response[0]),
                                                          dbus.Dictionary(response[1],
                                                                          signature="sv")))
        return dbus.ObjectPath(path)

    @dbus.service.method("org.freedesktop.portal.FileChooser", in_signature="ssa{sv}",
                         out_signature="o", sender_keyword="sender",
                         async_callbacks=("done", "failed"))
    def OpenFile(self, parent, title, options, sender, done, failed):
        if title != "slow":
            done(self.answer("OpenFile", sender, parent, title, options))

    @dbus.service.method("org.freedesktop.portal.FileChooser", in_signature="ssa{sv}",
                         out_signature="o", sender_keyword="sender")
    def SaveFile(self, parent, title, options, sender):
        return self.answer("SaveFile", sender, parent, title, options)


dbus.mainloop.glib.DBusGMainLoop(set_as_default=True)
bus = dbus.SessionBus()
name = dbus.service.BusName("org.freedesktop.portal.Desktop", bus)
portal = Portal(bus, "/org/freedesktop/portal/desktop")
print("ready", flush=True)
GLib.timeout_add_seconds(60, sys.exit)
GLib.MainLoop().run()
