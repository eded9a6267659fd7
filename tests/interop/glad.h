#pragma once
// The shape of a header that glad 1 generates: types, constants as macros, and functions that are
// macros for pointers. It claims the guards of GL/gl.h and GL/glext.h, as glad's does.

#define __gl_h_
#define __glext_h_
#define __GL_H__
#define __glcorearb_h_

#define APIENTRY
#define APIENTRYP APIENTRY*
#define GLAPIENTRY APIENTRY
#define GLAPI extern
#define GLAD_GL_VERSION_4_5 1
#define KHRONOS_APIENTRY
#define KHRONOS_APICALL

typedef unsigned int GLenum;
typedef unsigned int GLuint;
typedef unsigned int GLbitfield;
typedef int GLint;
typedef int GLsizei;
typedef unsigned char GLboolean;
typedef unsigned char GLubyte;
typedef float GLfloat;
typedef double GLclampd;
typedef void GLvoid;
typedef long GLintptr;
typedef long GLsizeiptr;
typedef signed long khronos_ssize_t;

#define GL_NONE 0
#define GL_NO_ERROR 0
#define GL_ONE 1
#define GL_POINTS 0x0000
#define GL_TRIANGLES 0x0004
#define GL_VERSION 0x1F02
#define GL_COLOR 0x1800
#define GL_DEPTH 0x1801
#define GL_RENDERER 0x1F01
#define GL_SHADER_STORAGE_BUFFER 0x90D2
#define GL_TRANSFORM_FEEDBACK 0x8E22
#define GL_ALWAYS 0x0207
#define GL_VIEWPORT 0x0BA2

typedef void(APIENTRYP PFNGLGENBUFFERSPROC)(GLsizei n, GLuint* buffers);
typedef const GLubyte*(APIENTRYP PFNGLGETSTRINGPROC)(GLenum name);
typedef void(APIENTRYP PFNGLVIEWPORTPROC)(GLint x, GLint y, GLsizei width, GLsizei height);
GLAPI PFNGLGENBUFFERSPROC glad_glGenBuffers;
GLAPI PFNGLGETSTRINGPROC glad_glGetString;
GLAPI PFNGLVIEWPORTPROC glad_glViewport;
#define glGenBuffers glad_glGenBuffers
#define glGetString glad_glGetString
#define glViewport glad_glViewport
