#pragma once
// What headers of window systems and toolkits define, in the order that they allow.

#define VK_USE_PLATFORM_XLIB_KHR
#define VK_USE_PLATFORM_WAYLAND_KHR
#include <X11/Xlib.h> // None, Bool, Status, Success, Always, True, …
#include <X11/Xutil.h>

#include <GL/gl.h>
#include <GL/glext.h>
#include <vulkan/vulkan.h>

#include <complex.h> // I
#include <sys/param.h>
#include <sys/sysmacros.h> // major, minor

// windows.h with NOMINMAX, which the standard library asks for
#define near
#define far
#define small char
#define hyper
#define interface struct
#define IN
#define OUT
#define OPTIONAL
#define CONST const
#define VOID void
#define ERROR 0
#define NO_ERROR 0L
#define DELETE 0x00010000L
#define DIFFERENCE 11
#define TRANSPARENT 1
#define OPAQUE 2
#define CreateEvent CreateEventA
#define GetObject GetObjectA
#define DrawText DrawTextA

// Qt
#define emit
#define slots
#define signals public
