/* The line to the host. An interrupt takes each byte that comes; DMA sends, with an interrupt after each piece. */
#include <string.h>

#include "board.h"
#include "registers.h"

#define STAMPS (sizeof((struct received *)0)->stamps / sizeof(uint16_t))
#define RING 512u /* bytes to send; a power of two */

/* The interrupt fills one box while the main loop reads the other. */
static struct received boxes[2];
static volatile uint8_t filling;

static uint8_t ring[RING];
static volatile uint16_t written, sent; /* bytes so far, modulo 2^16 */
static volatile uint16_t sending;       /* bytes that DMA is at, 0 if it rests */

void usart_start(uint32_t megahertz)
{
    GPIOA->CRH = 0x44444444u & ~(0xFFFu << 4);
    GPIOA->CRH |= 4u << 12 | PIN_PERIPHERAL << 4 | PIN_PULLED << 8;
    USART1->BRR = megahertz; /* 1 Mbaud */
    USART1->CR3 = USART_CR3_DMAT;
    USART1->CR1 = USART_CR1_UE | USART_CR1_TE | USART_CR1_RE | USART_CR1_RXNEIE;
    DMA1->channel[3].CPAR = (uint32_t)(uintptr_t)&USART1->DR;
    NVIC_IPR[IRQ_USART1] = 0;
    NVIC_IPR[IRQ_DMA1_CHANNEL4] = 0x40;
    NVIC_ISER[IRQ_USART1 / 32] = BIT(IRQ_USART1 % 32);
    NVIC_ISER[IRQ_DMA1_CHANNEL4 / 32] = BIT(IRQ_DMA1_CHANNEL4 % 32);
}

void usart_interrupt(void);
void usart_interrupt(void)
{
    struct received *box = &boxes[filling];
    const uint32_t flags = USART1->SR;
    const uint8_t byte = (uint8_t)USART1->DR; /* after SR: clears all flags */
    if (flags & USART_SR_ORE)
        box->lost++; /* the one after this */
    if (!(flags & USART_SR_RXNE))
        return;
    if ((flags & USART_SR_NOT_KEPT) || box->count == sizeof box->bytes) {
        box->lost++;
        return;
    }
    if (byte == 0 && box->zeros++ < STAMPS)
        box->stamps[box->zeros - 1] = counter_now();
    box->bytes[box->count++] = byte;
}

/* The interrupt is never half done while this runs, so that one store hands a box over. */
struct received *usart_take(void)
{
    struct received *taken = &boxes[filling], *next = &boxes[!filling];
    next->count = next->lost = next->zeros = 0;
    __asm__ volatile("" ::: "memory");
    filling = !filling;
    __asm__ volatile("" ::: "memory");
    return taken;
}

/* Only called while DMA rests: by its interrupt, or by the main loop when no interrupt is to come. */
static void send_next(void)
{
    const uint16_t begin = sent % RING, left = (uint16_t)(written - sent);
    sending = begin + left > RING ? (uint16_t)(RING - begin) : left;
    if (!sending)
        return;
    DMA1->channel[3].CMAR = (uint32_t)(uintptr_t)&ring[begin];
    DMA1->channel[3].CNDTR = sending;
    DMA1->channel[3].CCR = DMA_CCR_FROM_MEMORY | DMA_CCR_MINC | DMA_CCR_TCIE | DMA_CCR_EN;
}

void sent_interrupt(void);
void sent_interrupt(void)
{
    DMA1->IFCR = DMA_CLEAR_CHANNEL4;
    DMA1->channel[3].CCR = 0;
    sent = (uint16_t)(sent + sending);
    send_next();
}

void usart_send(const uint8_t *bytes, uint32_t count)
{
    if (count > RING - (uint16_t)(written - sent))
        return;
    const uint32_t begin = written % RING, room = RING - begin, first = count < room ? count : room;
    memcpy(&ring[begin], bytes, first);
    memcpy(ring, bytes + first, count - first);
    __asm__ volatile("" ::: "memory");
    written = (uint16_t)(written + count);
    if (!sending)
        send_next();
}
